//! Which command keys send: its own, or those that a person chose.

use super::Keys;
use crate::editor::command::{Command, CommandTable};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Which keys a person has given to commands, by the commands' ids; all others have their own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Bindings(BTreeMap<String, Vec<Keys>>);

impl Bindings {
    /// What sends this command.
    pub fn of<'a>(&'a self, command: &'a Command) -> &'a [Keys] {
        self.0.get(&*command.id).unwrap_or(&command.keys)
    }

    /// Whether a person chose them.
    pub fn is_chosen(&self, command: &Command) -> bool {
        self.0.contains_key(&*command.id)
    }

    /// Gives it these keys, and none to another command that had them; what it had before is gone.
    pub fn bind(&mut self, table: &CommandTable, command: &Command, keys: Vec<Keys>) {
        for other in table.rows() {
            let had = self.of(other);
            if other.id != command.id && had.iter().any(|had| keys.contains(had)) {
                let rest = had.iter().filter(|had| !keys.contains(had)).copied();
                let rest = rest.collect();
                self.0.insert(other.id.to_string(), rest);
            }
        }
        if keys == command.keys {
            self.0.remove(&*command.id);
        } else {
            self.0.insert(command.id.to_string(), keys);
        }
    }

    /// Gives a command its own keys again, and none of them to another.
    pub fn reset(&mut self, table: &CommandTable, command: &Command) {
        self.bind(table, command, command.keys.clone());
    }

    /// Gives every command its own keys again.
    pub fn reset_all(&mut self) {
        self.0.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(id: &'static str, keys: &[&str]) -> Command {
        Command::new(id, id, "", |_| {}).keys(keys)
    }

    fn table(rows: impl IntoIterator<Item = Command>) -> CommandTable {
        let mut table = CommandTable::default();
        rows.into_iter().for_each(|row| table.add(row));
        table
    }

    fn sent(table: &CommandTable, bindings: &Bindings, keys: &str) -> Option<String> {
        let row = table.of_keys(keys.parse().unwrap(), bindings)?;
        Some(row.id.to_string())
    }

    #[test]
    fn keys_that_a_person_gives_to_a_command_are_taken_from_the_other_until_they_are_reset() {
        let table = table([row("undo", &["Ctrl+Z"]), row("redo", &["Ctrl+Y", "Ctrl+U"])]);
        let mut bindings = Bindings::default();
        let [undo, redo] = ["undo", "redo"].map(|id| table.find(id).unwrap());
        bindings.bind(&table, undo, vec!["Ctrl+Y".parse().unwrap()]);
        assert_eq!(sent(&table, &bindings, "Ctrl+Y").as_deref(), Some("undo"));
        assert_eq!(sent(&table, &bindings, "Ctrl+Z"), None);
        assert_eq!(sent(&table, &bindings, "Ctrl+U").as_deref(), Some("redo"));
        assert!(table.conflicts(&bindings).is_empty());
        bindings.reset(&table, redo);
        assert_eq!(sent(&table, &bindings, "Ctrl+Y").as_deref(), Some("redo"));
        assert_eq!(bindings.of(undo), []);
        bindings.reset_all();
        assert_eq!(sent(&table, &bindings, "Ctrl+Z").as_deref(), Some("undo"));
    }

    #[test]
    fn keys_that_two_commands_want_are_named_and_the_first_has_them() {
        let table = table([row("a", &["F2"]), row("b", &["F3"])]);
        let bindings: Bindings = ron::from_str("{\"b\": [\"F2\"]}").unwrap();
        let conflicts = table.conflicts(&bindings);
        assert_eq!(conflicts.len(), 1);
        let (keys, rows) = &conflicts[0];
        assert_eq!(keys.text(), "F2");
        let ids: Vec<&str> = rows.iter().map(|row| &*row.id).collect();
        assert_eq!(ids, ["a", "b"]);
        assert_eq!(sent(&table, &bindings, "F2").as_deref(), Some("a"));
    }
}
