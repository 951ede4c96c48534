//! Assets: the page's files, as `web/` builds them (web/README.md).

/// A file of the page.
pub(crate) struct Asset {
    pub(crate) kind: &'static str,
    pub(crate) bytes: &'static [u8],
}

/// The file at a path of the page's address.
pub(crate) fn at(path: &str) -> Option<Asset> {
    let (kind, bytes): (_, &[u8]) = match path {
        "/" => ("text/html; charset=utf-8", include_bytes!("../assets/index.html")),
        "/app.js" => ("text/javascript; charset=utf-8", include_bytes!("../assets/app.js")),
        "/app.css" => ("text/css; charset=utf-8", include_bytes!("../assets/app.css")),
        "/licences.txt" => ("text/plain; charset=utf-8", include_bytes!("../assets/licences.txt")),
        _ => return None,
    };
    Some(Asset { kind, bytes })
}
