//! The system's clipboard, opened when it is first used.

/// The clipboard. On X11 what is copied is there as long as this is.
#[derive(Default)]
pub struct Clipboard(Option<arboard::Clipboard>);

impl Clipboard {
    /// Copies text; or says why not.
    pub fn copy(&mut self, text: &str) -> Result<(), String> {
        let words = |error: arboard::Error| format!("the clipboard cannot be used ({error})");
        if self.0.is_none() {
            self.0 = Some(arboard::Clipboard::new().map_err(words)?);
        }
        match &mut self.0 {
            Some(clipboard) => clipboard.set_text(text).map_err(words),
            None => Ok(()),
        }
    }
}
