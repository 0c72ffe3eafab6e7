//! What the sources say of each type, field, variant and constant: their documentation, and how long a
//! list or text may be.

use std::collections::BTreeMap;

use inm_protocol::update::{CHUNK, LOADER};
use inm_protocol::{
    AXES, BATCH_LEN, Flags, MAX_FRAME, MAX_MARK, MAX_PAYLOAD, REGISTERS, UNPROVEN_PERIODS, VERSION,
};
use syn::{
    Attribute, Expr, Fields, GenericArgument, ImplItem, Item, Lit, Meta, PathArguments, Type,
};

/// Constants that who speaks the protocol needs, with their values.
const CONSTANTS: [(&str, u64); 10] = [
    ("VERSION", VERSION as u64),
    ("AXES", AXES as u64),
    ("REGISTERS", REGISTERS as u64),
    ("BATCH_LEN", BATCH_LEN as u64),
    ("MAX_PAYLOAD", MAX_PAYLOAD as u64),
    ("MAX_FRAME", MAX_FRAME as u64),
    ("UNPROVEN_PERIODS", UNPROVEN_PERIODS),
    ("MAX_MARK", MAX_MARK as u64),
    ("LOADER", LOADER as u64),
    ("CHUNK", CHUNK as u64),
];

/// Bits of a flag byte; that none is missing is checked against the source.
const FLAGS: [(&str, Flags); 6] = [
    ("NONE", Flags::NONE),
    ("OVER_RANGE", Flags::OVER_RANGE),
    ("TORN", Flags::TORN),
    ("MISSED", Flags::MISSED),
    ("SLIPPED", Flags::SLIPPED),
    ("STUCK", Flags::STUCK),
];

/// What is said of `Type`, `Type.field`, `Type.Variant`, `Type.Variant.field` and `CONSTANT`.
#[derive(Default)]
pub struct Docs {
    said: BTreeMap<String, String>,
    limits: BTreeMap<String, String>,
    flags: Vec<String>,
}

impl Docs {
    /// Of all files of the crate.
    pub fn of_sources() -> Self {
        let mut docs = Self::default();
        // Rust's own.
        for (name, said) in [
            ("Result", "Whether a request was carried out."),
            ("Result.Ok", "It was."),
            ("Result.Err", "It was not."),
        ] {
            docs.said.insert(name.into(), said.into());
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src");
        for file in std::fs::read_dir(folder).expect("sources") {
            let path = file.expect("a file").path();
            let text = std::fs::read_to_string(&path).expect("a source");
            let file = syn::parse_file(&text).expect("Rust");
            file.items.iter().for_each(|item| docs.item(item));
        }
        docs
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Const(one) => self.say(one.ident.to_string(), &one.attrs),
            Item::Struct(one) => {
                let name = one.ident.to_string();
                self.say(name.clone(), &one.attrs);
                self.fields(&name, &one.fields);
            }
            Item::Enum(one) => {
                let name = one.ident.to_string();
                self.say(name.clone(), &one.attrs);
                for variant in &one.variants {
                    let path = format!("{name}.{}", variant.ident);
                    self.say(path.clone(), &variant.attrs);
                    self.fields(&path, &variant.fields);
                }
            }
            Item::Impl(one) if matches!(&*one.self_ty, Type::Path(of) if of.path.is_ident("Flags")) => {
                for item in &one.items {
                    if let ImplItem::Const(flag) = item {
                        self.say(format!("Flags.{}", flag.ident), &flag.attrs);
                        self.flags.push(flag.ident.to_string());
                    }
                }
            }
            _ => {}
        }
    }

    fn fields(&mut self, path: &str, fields: &Fields) {
        for field in fields {
            let Some(name) = &field.ident else { continue };
            let path = format!("{path}.{name}");
            self.say(path.clone(), &field.attrs);
            if let Some(limit) = capacity(&field.ty) {
                self.limits.insert(path, limit);
            }
        }
    }

    fn say(&mut self, name: String, attributes: &[Attribute]) {
        let lines = attributes.iter().filter_map(doc_line);
        let text = lines
            .filter(|line| !line.is_empty())
            .collect::<Vec<_>>()
            .join(" ");
        self.said.insert(name, plain(&text));
    }

    /// What is said of it.
    pub fn of(&self, name: &str) -> &str {
        let said = self.said.get(name).filter(|said| !said.is_empty());
        said.unwrap_or_else(|| panic!("{name} is not documented"))
    }

    /// How long a list or a text may be, as an addition to its form.
    pub fn limit(&self, name: &str) -> String {
        let limit = self.limits.get(name);
        limit.map_or(String::new(), |limit| format!(", at most {limit}"))
    }

    /// The constants as a table.
    pub fn constants(&self) -> String {
        let rows =
            CONSTANTS.map(|(name, value)| format!("| `{name}` | {value} | {} |\n", self.of(name)));
        let head = "#### Constants\n\n| name | value | meaning |\n|---|---|---|\n";
        format!("{head}{}\n", rows.concat())
    }

    /// Constants and flag bits for a client in Python.
    pub fn python(&self) -> String {
        let constants = CONSTANTS.map(|(name, value)| format!("{name} = {value}\n"));
        let flags = FLAGS.map(|(name, Flags(bits))| format!("\"{name}\": {bits}"));
        format!("{}FLAGS = {{{}}}\n", constants.concat(), flags.join(", "))
    }

    /// The bits of a flag byte as a table.
    pub fn flags(&self) -> String {
        assert_eq!(
            self.flags,
            FLAGS.map(|(name, _)| name),
            "a flag is missing here"
        );
        let rows = FLAGS.map(|(name, Flags(bits))| {
            let meaning = self.of(&format!("Flags.{name}"));
            format!("| {bits:02x} | `{name}` | {meaning} |\n")
        });
        let head =
            "#### Bits of a flag byte\n\n| bits, hexadecimal | name | meaning |\n|---|---|---|\n";
        format!("{head}{}\n", rows.concat())
    }
}

/// One line of documentation.
fn doc_line(attribute: &Attribute) -> Option<String> {
    let Meta::NameValue(pair) = &attribute.meta else {
        return None;
    };
    let Expr::Lit(literal) = &pair.value else {
        return None;
    };
    match &literal.lit {
        Lit::Str(text) if pair.path.is_ident("doc") => Some(text.value().trim().to_owned()),
        _ => None,
    }
}

/// Text without links into the crate's documentation, for a cell of a table.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, inside)) = rest.split_once("[`") {
        plain += before;
        let (name, after) = inside.split_once("`]").expect("the end of a link");
        plain += &format!("`{name}`");
        // Where it leads.
        rest = match after.strip_prefix('(') {
            Some(target) => target.split_once(')').expect("the end of a target").1,
            None => after,
        };
    }
    plain += rest;
    plain.replace('|', "\\|").replace("Self::", "")
}

/// The last argument of `Vec<T, N>` or `String<N>`, in words.
fn capacity(kind: &Type) -> Option<String> {
    let Type::Path(path) = kind else { return None };
    let segment = path.path.segments.last()?;
    if segment.ident != "Vec" && segment.ident != "String" {
        return None;
    }
    let PathArguments::AngleBracketed(arguments) = &segment.arguments else {
        return None;
    };
    match arguments.args.last()? {
        GenericArgument::Const(Expr::Lit(literal)) => match &literal.lit {
            Lit::Int(number) => Some(number.base10_digits().to_owned()),
            _ => None,
        },
        GenericArgument::Const(_) => Some("`AXES` × `BATCH_LEN`".into()),
        GenericArgument::Type(Type::Path(name)) => Some(format!("`{}`", name.path.get_ident()?)),
        _ => None,
    }
}
