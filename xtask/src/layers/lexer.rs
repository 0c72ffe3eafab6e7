//! Rust source as words and signs, without comments and tests, and without literals unless they are asked for.

/// The words and signs of a source file, `::` as one of them.
pub fn tokens(text: &str) -> Vec<&str> {
    split(text, false)
}

/// The same with its string literals among them, each with its marks.
pub fn tokens_with_strings(text: &str) -> Vec<&str> {
    split(text, true)
}

/// What a string literal holds, as it is written; `None` for any other token.
pub fn content(token: &str) -> Option<&str> {
    let body = token.trim_start_matches(['b', 'c', 'r']).trim_matches('#');
    body.strip_prefix('"')?.strip_suffix('"')
}

fn split(text: &str, with_strings: bool) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let word = rest
            .find(|c: char| !c.is_alphanumeric() && c != '_')
            .unwrap_or(rest.len());
        let (len, counts) = if rest.starts_with("//") {
            (rest.find('\n').unwrap_or(rest.len()), false)
        } else if rest.starts_with("/*") {
            (rest.find("*/").map_or(rest.len(), |at| at + 2), false)
        } else if let Some(len) = string(rest) {
            (len, with_strings)
        } else if first == '\'' {
            (character(rest), false)
        } else if word > 0 {
            (word, true)
        } else if rest.starts_with("::") {
            (2, true)
        } else {
            (first.len_utf8(), !first.is_whitespace())
        };
        if counts {
            tokens.push(&rest[..len]);
        }
        rest = &rest[len..];
    }
    tokens
}

/// Length of the string literal that `text` begins with, raw or not.
fn string(text: &str) -> Option<usize> {
    let body = text.trim_start_matches(['b', 'c']);
    let prefix = text.len() - body.len();
    if let Some(raw) = body.strip_prefix('r').filter(|_| prefix < 2) {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        let open = raw[hashes..].strip_prefix('"')?;
        let end = format!("\"{}", "#".repeat(hashes));
        let len = open.find(&end).map_or(open.len(), |at| at + end.len());
        return Some(prefix + 1 + hashes + 1 + len);
    }
    let open = body.strip_prefix('"').filter(|_| prefix < 2)?;
    let mut escaped = false;
    let len = open.find(|c| {
        let ends = c == '"' && !escaped;
        escaped = c == '\\' && !escaped;
        ends
    });
    Some(prefix + 1 + len.map_or(open.len(), |at| at + 1))
}

/// Length of the character that `text` begins with; that of the mark alone for a lifetime.
fn character(text: &str) -> usize {
    let mut inner = text.char_indices().skip(1);
    match (inner.next(), inner.next()) {
        (Some((_, '\\')), Some((at, escaped))) => {
            let after = at + escaped.len_utf8();
            text[after..]
                .find('\'')
                .map_or(text.len(), |end| after + end + 1)
        }
        (Some(_), Some((at, '\''))) => at + 1,
        _ => 1,
    }
}

/// Leaves out every item behind `#[cfg(test)]`. Also the names of the modules among them that are
/// files of their own.
pub fn without_tests<'t>(tokens: &[&'t str]) -> (Vec<&'t str>, Vec<&'t str>) {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut files) = (Vec::new(), Vec::new());
    let mut rest = tokens;
    while let Some(&first) = rest.first() {
        if !rest.starts_with(&MARK) {
            kept.push(first);
            rest = &rest[1..];
            continue;
        }
        let end = item_end(&rest[MARK.len()..]) + MARK.len();
        if let [.., "mod", name, ";"] = rest[..end] {
            files.push(name);
        }
        rest = &rest[end..];
    }
    (kept, files)
}

/// Tokens of the item that begins here: up to a semicolon, or to the end of its braces.
fn item_end(tokens: &[&str]) -> usize {
    let mut depth = 0_usize;
    for (at, &token) in tokens.iter().enumerate() {
        match token {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 && matches!(token, ";" | "}") {
            return at + 1;
        }
    }
    tokens.len()
}
