//! The tables of WIRE.md are made of the types: order and form of the fields as serde meets them,
//! meaning and unit as the types' own documentation says.
//!
//! `INM_WRITE_TABLES=1 cargo test -p inm-protocol --test wire_tables` writes them anew; without it a
//! type that differs from its table is a failure.

mod docs;
mod form;

use docs::Docs;
use form::Forms;

/// A part of a file that is not written by hand, between two lines.
struct Made {
    file: &'static str,
    begin: &'static str,
    end: &'static str,
}

const TABLES: Made = Made {
    file: "WIRE.md",
    begin: "<!-- made of the types: INM_WRITE_TABLES=1 cargo test -p inm-protocol --test wire_tables -->\n",
    end: "<!-- end of what is made of the types -->",
};

const PYTHON: Made = Made {
    file: "python/inm_client.py",
    begin: "# --- made of the types: INM_WRITE_TABLES=1 cargo test -p inm-protocol --test wire_tables\n",
    end: "# --- end of what is made of the types",
};

/// If set, they are written instead of compared.
const WRITE: &str = "INM_WRITE_TABLES";

impl Made {
    /// Holds the file to what was made; `INM_WRITE_TABLES` writes it there.
    fn hold(&self, made: &str) {
        let path = format!("{}/{}", env!("CARGO_MANIFEST_DIR"), self.file);
        let text = std::fs::read_to_string(&path).expect("a file of this crate");
        let (before, rest) = text
            .split_once(self.begin)
            .expect("the line that begins it");
        let (written, after) = rest.split_once(self.end).expect("the line that ends it");
        if std::env::var_os(WRITE).is_some() {
            let all = [before, self.begin, made, self.end, after].concat();
            std::fs::write(path, all).expect("it can be written");
            return;
        }
        let differs = written.lines().zip(made.lines()).find(|(a, b)| a != b);
        assert!(
            written == made,
            "{} is not what the types are: raise the version if bytes changed their meaning, then \
             {WRITE}=1 cargo test -p inm-protocol --test wire_tables\nwritten and made, the first \
             line that differs: {differs:#?}",
            self.file
        );
    }
}

#[test]
fn the_tables_of_the_wire_are_those_of_the_types() {
    TABLES.hold(&tables(&Forms::of_messages(), &Docs::of_sources()));
}

#[test]
fn the_client_in_python_has_the_types() {
    let (forms, docs) = (Forms::of_messages(), Docs::of_sources());
    let codes = "CODES = (\"list\", (\"array\", 3, \"Code\"))\n";
    PYTHON.hold(&[docs.python(), forms.python(), codes.into()].concat());
}

/// A change of a type changes its table: shown on a form and a documentation that are changed here.
#[test]
fn a_field_that_moves_and_a_variant_that_comes_change_the_tables() {
    let (forms, docs) = (Forms::of_messages(), Docs::of_sources());
    let made = tables(&forms, &docs);
    for change in [Forms::swap_fields, Forms::add_variant, Forms::widen] {
        let mut changed = Forms::of_messages();
        change(&mut changed);
        assert_ne!(tables(&changed, &docs), made);
    }
    assert!(!made.contains("| |"), "something is not documented");
}

/// All tables, in the order in which a reader meets the types.
fn tables(forms: &Forms, docs: &Docs) -> String {
    let types = forms.in_order();
    assert!(types.contains(&"Batch".to_owned()), "{types:?}");
    let mut text = docs.constants() + &docs.flags();
    for name in types {
        text += &forms.table(&name, docs);
    }
    text
}
