//! What an image contains: sections, functions, and which functions a function can reach.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

/// A linked image for a Cortex-M.
pub(crate) struct Image {
    /// Bytes of code.
    pub text: u64,
    /// Bytes of flash: vectors, code, constants and the start values of variables.
    pub flash: u64,
    /// Bytes of RAM without the stack.
    pub ram: u64,
    functions: BTreeMap<u64, Function>,
    /// Every name in the symbol table.
    pub names: Vec<String>,
}

struct Function {
    name: String,
    size: u64,
    calls: BTreeSet<u64>,
    indirect: bool,
}

/// What one function can reach.
#[derive(Debug)]
pub(crate) struct Reach {
    /// Bytes of all functions that can be reached, the first included.
    pub text: u64,
    /// Their names.
    pub names: Vec<String>,
    /// Whether one of them calls through a pointer, so that the list may not be complete.
    pub indirect: bool,
}

impl Image {
    /// Reads an image.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let bytes = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let file =
            object::File::parse(&*bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        let size = |name| {
            file.section_by_name(name)
                .map_or(0, |section| section.size())
        };
        let section = file
            .section_by_name(".text")
            .ok_or("the image has no .text")?;
        let code = section.data().map_err(|error| error.to_string())?;
        let range = section.address()..section.address() + section.size();
        let mut functions = BTreeMap::new();
        let mut names = Vec::new();
        // Where data begins and ends within the code: the mapping symbols $d and $t of the ARM ELF
        // specification.
        let mut mapping = BTreeMap::new();
        for symbol in file.symbols() {
            let name = symbol.name().unwrap_or_default().to_owned();
            let address = symbol.address() & !1;
            match name.as_bytes() {
                [b'$', kind @ (b't' | b'd'), ..] => {
                    mapping.insert(address, *kind == b'd');
                }
                _ if symbol.kind() == SymbolKind::Text
                    && symbol.size() > 0
                    && range.contains(&address) =>
                {
                    let function = Function {
                        name: name.clone(),
                        size: symbol.size(),
                        calls: BTreeSet::new(),
                        indirect: false,
                    };
                    functions.insert(address, function);
                    names.push(name);
                }
                _ => names.push(name),
            }
        }
        for (&start, function) in &mut functions {
            scan(code, section.address(), start, function, &mapping);
        }
        Ok(Self {
            text: size(".text"),
            flash: size(".vector_table") + size(".text") + size(".rodata") + size(".data"),
            ram: size(".data") + size(".bss") + size(".uninit"),
            functions,
            names,
        })
    }

    /// What the function with this name can reach.
    pub(crate) fn reach(&self, name: &str) -> Result<Reach, String> {
        let (&first, _) = self
            .functions
            .iter()
            .find(|(_, function)| function.name == name)
            .ok_or_else(|| format!("the image has no function {name}"))?;
        let mut seen = BTreeSet::new();
        let mut open = vec![first];
        while let Some(address) = open.pop() {
            let Some((&start, function)) = self.functions.range(..=address).next_back() else {
                continue;
            };
            if address < start + function.size && seen.insert(start) {
                open.extend(&function.calls);
            }
        }
        let reached = || seen.iter().map(|start| &self.functions[start]);
        Ok(Reach {
            text: reached().map(|function| function.size).sum(),
            names: reached().map(|function| function.name.clone()).collect(),
            indirect: reached().any(|function| function.indirect),
        })
    }
}

/// Finds the calls and far jumps of one function (ARMv7-M reference manual, A5 and A7).
fn scan(
    code: &[u8],
    base: u64,
    start: u64,
    function: &mut Function,
    mapping: &BTreeMap<u64, bool>,
) {
    let end = start + function.size;
    let half = |address: u64| {
        let at = (address - base) as usize;
        code.get(at..at + 2)
            .map_or(0, |bytes| u16::from_le_bytes([bytes[0], bytes[1]]))
    };
    let mut address = start;
    while address < end {
        if mapping
            .range(..=address)
            .next_back()
            .is_some_and(|(_, &data)| data)
        {
            address += 2;
            continue;
        }
        let first = half(address);
        let long = first >> 11 >= 0b11101;
        let target = if long {
            branch(first, half(address + 2)).map(|offset| address.wrapping_add_signed(4 + offset))
        } else {
            // BLX of a register; a BX other than a return is a jump through a pointer too.
            function.indirect |=
                first & 0xFF80 == 0x4780 || (first & 0xFF80 == 0x4700 && first != 0x4770);
            // The short jump, which may be the last call of a function.
            (first >> 11 == 0b11100)
                .then(|| address.wrapping_add_signed(4 + (i64::from(first & 0x7FF) << 53 >> 52)))
        };
        if let Some(target) = target
            && !(start..end).contains(&target)
        {
            function.calls.insert(target);
        }
        address += if long { 4 } else { 2 };
    }
}

/// Offset of BL, B.W and of the conditional B.W.
fn branch(first: u16, second: u16) -> Option<i64> {
    if first >> 11 != 0b11110 || second >> 15 == 0 {
        return None;
    }
    let sign = i64::from(first >> 10 & 1);
    let (j1, j2) = (i64::from(second >> 13 & 1), i64::from(second >> 11 & 1));
    let low = i64::from(second & 0x7FF) << 1;
    match (second >> 14 & 1, second >> 12 & 1) {
        (_, 1) => {
            let (i1, i2) = (1 ^ j1 ^ sign, 1 ^ j2 ^ sign);
            let high = i64::from(first & 0x3FF) << 12;
            Some((i1 << 23 | i2 << 22 | high | low) - (sign << 24))
        }
        // Conditions 14 and 15 are other instructions.
        (0, 0) if first >> 7 & 7 != 7 => {
            let high = i64::from(first & 0x3F) << 12;
            Some((j2 << 19 | j1 << 18 | high | low) - (sign << 20))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_are_decoded() {
        // Encodings by the GNU assembler.
        assert_eq!(
            branch(0xF000, 0xF800),
            Some(0),
            "bl to the next instruction"
        );
        assert_eq!(branch(0xF7FF, 0xFFFE), Some(-4), "bl to itself");
        assert_eq!(branch(0xF7FF, 0xBFFE), Some(-4), "b.w to itself");
        assert_eq!(branch(0xF43F, 0xAFFE), Some(-4), "beq.w to itself");
        assert_eq!(
            branch(0xF7FD, 0xFCED),
            Some(-0x2626),
            "bl of a listing: 0x8006c66 to 0x8004644"
        );
        assert_eq!(branch(0xF3BF, 0x8F4F), None, "dsb");
        assert_eq!(branch(0xF894, 0x015C), None, "ldrb");
    }
}
