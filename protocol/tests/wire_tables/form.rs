//! What serde writes of each type: names, order and form of its fields, numbers of its variants.

use inm_protocol::update::{FromLoader, LoaderRefusal, ToLoader};
use inm_protocol::{
    Answer, Filter, Note, Phase, Rate, Refusal, Request, Restart, SensorRange, ToBoard, ToHost,
    Trouble,
};
use serde_reflection::{
    ContainerFormat, Format, FormatHolder, Named, Registry, Samples, Tracer, TracerConfig,
    VariantFormat,
};

use crate::docs::Docs;

/// Messages of either direction, of the program and of the loader: the first types of the document.
const ROOTS: [&str; 4] = ["ToBoard", "ToHost", "ToLoader", "FromLoader"];

/// The forms of all types that a message can hold.
pub struct Forms(Registry);

impl Forms {
    /// Of both messages and all that is in them.
    pub fn of_messages() -> Self {
        let mut tracer = Tracer::new(TracerConfig::default());
        let samples = Samples::new();
        macro_rules! trace {
            ($($kind:ty),*) => {
                $(tracer.trace_type::<$kind>(&samples).expect(stringify!($kind));)*
            };
        }
        // Every enumeration by name: within another type only its first variant is met.
        trace!(
            Phase,
            Filter, Rate, SensorRange, Restart, Trouble, Refusal, Note
        );
        trace!(Request, Answer, Result<Answer, Refusal>, ToBoard, ToHost);
        trace!(LoaderRefusal, ToLoader, FromLoader);
        Self(tracer.registry().expect("every variant of every type"))
    }

    /// The types, each behind the first that holds it.
    pub fn in_order(&self) -> Vec<String> {
        let mut order: Vec<String> = Vec::new();
        let mut open: Vec<String> = ROOTS.iter().rev().map(|&name| name.into()).collect();
        while let Some(name) = open.pop() {
            if order.contains(&name) {
                continue;
            }
            let mut held = Vec::new();
            let visit = self.0[&name].visit(&mut |format: &Format| {
                if let Format::TypeName(name) = format {
                    held.push(name.clone());
                }
                Ok(())
            });
            visit.expect("a known form");
            open.extend(held.into_iter().rev());
            order.push(name);
        }
        order
    }

    /// One type as a table.
    pub fn table(&self, name: &str, docs: &Docs) -> String {
        let about = docs.of(name);
        match &self.0[name] {
            ContainerFormat::Struct(fields) => {
                let rows = (1..).zip(fields).map(|(at, field)| {
                    let meaning = docs.of(&format!("{name}.{}", field.name));
                    let form = form(&field.value) + &docs.limit(&format!("{name}.{}", field.name));
                    format!("| {at} | `{}` | {form} | {meaning} |\n", field.name)
                });
                let head = "| field | name | form | meaning |\n|---|---|---|---|\n";
                format!(
                    "#### {name}\n\n{about}\n\n{head}{}\n",
                    rows.collect::<String>()
                )
            }
            ContainerFormat::Enum(variants) => {
                let rows = variants.iter().map(|(number, variant)| {
                    let path = format!("{name}.{}", variant.name);
                    let holds = holds(&path, &variant.value, docs);
                    let meaning = docs.of(&path);
                    format!("| {number} | `{}` | {holds} | {meaning} |\n", variant.name)
                });
                let head = "| number | name | followed by | meaning |\n|---|---|---|---|\n";
                format!(
                    "#### {name}\n\n{about}\n\n{head}{}\n",
                    rows.collect::<String>()
                )
            }
            ContainerFormat::NewTypeStruct(inner) => {
                let form = form(inner);
                format!("#### {name}\n\n{about}\n\nForm: {form}.\n\n")
            }
            other => panic!("{name}: no table is made of {other:?}"),
        }
    }

    /// The types as the table of a client in Python.
    pub fn python(&self) -> String {
        let rows = self.in_order().into_iter().map(|name| {
            let content = match &self.0[&name] {
                ContainerFormat::Struct(fields) => format!("(\"struct\", {})", literals(fields)),
                ContainerFormat::NewTypeStruct(inner) => {
                    format!("(\"newtype\", {})", literal(inner))
                }
                ContainerFormat::Enum(variants) => {
                    let variants = variants.values().map(|variant| {
                        let holds = match &variant.value {
                            VariantFormat::Unit => "None".into(),
                            VariantFormat::NewType(inner) => literal(inner),
                            VariantFormat::Struct(fields) => literals(fields),
                            other => panic!("{name}: no literal of {other:?}"),
                        };
                        format!("        (\"{}\", {holds}),\n", variant.name)
                    });
                    format!("(\"enum\", [\n{}    ])", variants.collect::<String>())
                }
                other => panic!("{name}: no literal of {other:?}"),
            };
            format!("    \"{name}\": {content},\n")
        });
        format!("TYPES = {{\n{}}}\n", rows.collect::<String>())
    }

    /// The first two fields of a batch change places.
    pub fn swap_fields(&mut self) {
        let Some(ContainerFormat::Struct(fields)) = self.0.get_mut("Batch") else {
            panic!("a batch has fields");
        };
        fields.swap(0, 1);
    }

    /// A trouble more.
    pub fn add_variant(&mut self) {
        let Some(ContainerFormat::Enum(variants)) = self.0.get_mut("Trouble") else {
            panic!("there are kinds of trouble");
        };
        let new = Named {
            name: "Stalled".into(),
            value: VariantFormat::Unit,
        };
        variants.insert(variants.len() as u32, new);
    }

    /// A code of another size.
    pub fn widen(&mut self) {
        self.0.insert(
            "Code".into(),
            ContainerFormat::NewTypeStruct(Box::new(Format::I64)),
        );
    }
}

/// What stands behind the number of a variant.
fn holds(path: &str, format: &VariantFormat, docs: &Docs) -> String {
    match format {
        VariantFormat::Unit => "nothing".into(),
        VariantFormat::NewType(inner) => form(inner),
        VariantFormat::Struct(fields) => {
            let fields = fields.iter().map(|field| {
                let meaning = docs.of(&format!("{path}.{}", field.name));
                let limit = docs.limit(&format!("{path}.{}", field.name));
                let meaning = meaning.trim_end_matches('.');
                format!("`{}` {}{limit}: {meaning}", field.name, form(&field.value))
            });
            fields.collect::<Vec<_>>().join("; ")
        }
        other => panic!("{path}: no table is made of {other:?}"),
    }
}

/// Fields as a list in Python.
fn literals(fields: &[Named<Format>]) -> String {
    let fields = fields.iter();
    let pairs = fields.map(|field| format!("(\"{}\", {})", field.name, literal(&field.value)));
    format!("[{}]", pairs.collect::<Vec<_>>().join(", "))
}

/// A form in Python: a name, or a tuple.
fn literal(format: &Format) -> String {
    match format {
        Format::Option(inner) => format!("(\"option\", {})", literal(inner)),
        Format::Seq(inner) => format!("(\"list\", {})", literal(inner)),
        Format::TupleArray { content, size } => {
            format!("(\"array\", {size}, {})", literal(content))
        }
        Format::TypeName(name) => format!("\"{name}\""),
        number => format!("\"{}\"", form(number)),
    }
}

/// A form in words.
fn form(format: &Format) -> String {
    match format {
        Format::TypeName(name) => format!("[{name}](#{})", name.to_lowercase()),
        Format::Bool => "bool".into(),
        Format::U8 => "u8".into(),
        Format::U16 => "u16".into(),
        Format::U32 => "u32".into(),
        Format::U64 => "u64".into(),
        Format::I16 => "i16".into(),
        Format::I32 => "i32".into(),
        Format::I64 => "i64".into(),
        Format::Str => "text".into(),
        Format::Option(inner) => format!("option of {}", form(inner)),
        Format::Seq(inner) => format!("list of {}", form(inner)),
        Format::TupleArray { content, size } => format!("{size} times {}", form(content)),
        other => panic!("no words for {other:?}"),
    }
}
