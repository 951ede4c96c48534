//! ELF: the firmware as a debug probe would program it.

use crate::chip::flash::Flash;
use object::{
    Architecture, LittleEndian, Object, ObjectSegment, ObjectSymbol,
    read::elf::{ElfFile32, ProgramHeader},
};
use std::{
    io,
    path::{Path, PathBuf},
};

/// What goes into the flash, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Pieces in order of their addresses.
    pub segments: Vec<Segment>,
    symbols: Vec<(String, u32)>,
}

/// One piece.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Where it goes.
    pub address: u32,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// Why a file is no firmware.
#[derive(Debug, thiserror::Error)]
pub enum ElfError {
    /// It cannot be read.
    #[error("cannot read the firmware `{}`: {reason} (build it with firmware/build)", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// It is no 32-bit little-endian ELF for ARM.
    #[error("`{}` is no ELF for a Cortex-M: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A piece of it does not go into this chip's flash.
    #[error(
        "`{}` puts {bytes} bytes at {address:#010x}; the flash of this chip is 0x08000000 to 0x0807ffff",
        path.display()
    )]
    Place {
        /// The file.
        path: PathBuf,
        /// Where the piece goes.
        address: u32,
        /// Its length.
        bytes: usize,
    },
}

impl Image {
    /// Reads an ELF.
    pub fn read(path: &Path) -> Result<Self, ElfError> {
        let bytes = std::fs::read(path).map_err(|reason| ElfError::Read { path: path.to_owned(), reason })?;
        Self::parse(path, &bytes)
    }

    fn parse(path: &Path, bytes: &[u8]) -> Result<Self, ElfError> {
        let format = |reason: String| ElfError::Format { path: path.to_owned(), reason };
        let elf = ElfFile32::<LittleEndian>::parse(bytes).map_err(|error| format(error.to_string()))?;
        if elf.architecture() != Architecture::Arm {
            return Err(format(format!("it is for {:?}", elf.architecture())));
        }
        let mut segments = Vec::new();
        for segment in elf.segments() {
            let data = segment.data().map_err(|error| format(error.to_string()))?;
            // Where it is programmed, which for initialised data is not where it runs.
            let address = segment.elf_program_header().p_paddr(elf.endian());
            if !data.is_empty() {
                segments.push(Segment { address, bytes: data.to_vec() });
            }
        }
        let fits = |segment: &&Segment| {
            let end = u64::from(segment.address) + segment.bytes.len() as u64;
            segment.address >= 0x0800_0000 && end <= 0x0808_0000
        };
        if let Some(segment) = segments.iter().find(|segment| !fits(segment)) {
            let (address, bytes) = (segment.address, segment.bytes.len());
            return Err(ElfError::Place { path: path.to_owned(), address, bytes });
        }
        if segments.is_empty() {
            return Err(format("it has nothing to program".to_owned()));
        }
        let symbols = elf
            .symbols()
            .filter_map(|symbol| Some((symbol.name().ok()?.to_owned(), symbol.address() as u32)));
        Ok(Self { symbols: symbols.collect(), segments })
    }

    /// A flash with this in it and nothing else.
    #[must_use]
    pub fn flash(&self) -> Flash {
        let mut flash = Flash::default();
        for segment in &self.segments {
            flash.load(segment.address, &segment.bytes);
        }
        flash
    }

    /// Address of the first symbol whose name holds these letters.
    #[must_use]
    pub fn symbol(&self, part: &str) -> Option<u32> {
        self.symbols.iter().find(|(name, _)| name.contains(part)).map(|&(_, address)| address)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_firmware_is_refused_with_its_name() {
        let error = Image::read(Path::new("no/such/file.elf")).unwrap_err().to_string();
        assert!(error.contains("no/such/file.elf") && error.contains("firmware/build"), "{error}");
        let error = Image::parse(Path::new("text.elf"), b"hello").unwrap_err().to_string();
        assert!(error.contains("text.elf") && error.contains("no ELF"), "{error}");
        let host = std::env::current_exe().unwrap();
        let error = Image::read(&host).unwrap_err().to_string();
        assert!(error.contains("no ELF for a Cortex-M"), "{error}");
    }
}
