//! Bench: the board, the skin and the person that the steps have in common, and what they can do to the board.

use super::{Args, SmallestPress, Step, order, person::Person};
use crate::commands::{board::open, check_skin::Compared, progress, tare::patch_of};
use anyhow::Context;
use dermatome_frames::recorded::order::Arrangement;
use dermatome_link::{self as link, Link, health::Finding};
use dermatome_model::{model::Model, quantize, skin::Skin};
use dermatome_patch::input;
use dermatome_shared::{patch::PatchView, protocol::PatchInfo};
use toml_edit::{DocumentMut, Item, value};

/// What all steps work on.
pub(super) struct Bench<'a> {
    pub(super) args: &'a Args,
    pub(super) person: Person,
    pub(super) link: Link,
    /// The skin file's text, with what was corrected, and the skin that it describes.
    pub(super) text: String,
    pub(super) skin: Skin,
    written: String,
    built: Option<Built>,
    /// Checksum of the patch that the board uses.
    pub(super) on_board: Option<u32>,
    pub(super) amplitude: Option<f32>,
    pub(super) compared: Option<Compared>,
    pub(super) snr_db: Option<f64>,
    pub(super) smallest_press: Option<SmallestPress>,
    pub(super) steps: Vec<Step>,
}

/// What the skin's text gives.
pub(super) struct Built {
    pub(super) model: Model,
    pub(super) patch: Vec<u8>,
    pub(super) crc: u32,
}

impl<'a> Bench<'a> {
    pub(super) fn new(args: &'a Args, person: Person) -> anyhow::Result<Self> {
        let skin = Skin::load(&args.skin)?.made()?;
        let file = args.skin.display();
        quantize::check_drive(&skin).with_context(|| format!("skin file `{file}`"))?;
        let text = input::read_text(&args.skin).with_context(|| format!("cannot read skin file `{file}`"))?;
        let link = open(&args.port)?;
        Ok(Self {
            args,
            person,
            link,
            written: text.clone(),
            text,
            skin,
            built: None,
            on_board: None,
            amplitude: None,
            compared: None,
            snr_db: None,
            smallest_press: None,
            steps: Vec::new(),
        })
    }

    /// Prints and keeps what a step found; one that is done again takes the place of its former self.
    pub(super) fn tell(&mut self, step: Step) {
        step.print();
        self.steps.retain(|other| other.step != step.step);
        self.steps.push(step);
    }

    pub(super) fn in_file(&self) -> String {
        format!("skin file `{}`", self.args.skin.display())
    }

    /// The skin's patch, built where that has not been done.
    pub(super) fn built(&mut self) -> anyhow::Result<&Built> {
        if self.built.is_none() {
            let spinner = progress::spinner();
            let model = Model::build(&self.skin, |stage| spinner.set_message(stage))
                .with_context(|| self.in_file())?;
            let patch = quantize::patch(&self.skin, &model).with_context(|| self.in_file())?;
            spinner.finish_and_clear();
            let crc = PatchView::validate(&patch)?.crc();
            self.built = Some(Built { model, patch, crc });
        }
        self.built.as_ref().context("the patch was built just now")
    }

    /// Sends the skin's patch to the board.
    pub(super) fn flash(&mut self) -> anyhow::Result<()> {
        self.built()?;
        let Self { built: Some(built), link, .. } = self else { return Ok(()) };
        let bar = progress::sending(built.patch.len());
        let result = link::upload(link, &built.patch, |sent| bar.inc(sent as u64));
        bar.finish_and_clear();
        self.on_board = Some(result.context("the skin's patch was not sent")?.crc);
        Ok(())
    }

    /// The patch on the board, with the drive in effect.
    pub(super) fn patch(&mut self) -> anyhow::Result<PatchInfo> {
        patch_of(&mut self.link)
    }

    /// The patch that the board uses, if it was built here.
    pub(super) fn patch_on_board(&self) -> Option<&[u8]> {
        let built = self.built.as_ref()?;
        (self.on_board == Some(built.crc)).then_some(&*built.patch)
    }

    /// Whether the board's patch is the skin's, so that a corrected one may take its place.
    pub(super) fn may_replace(&mut self) -> anyhow::Result<bool> {
        Ok(self.on_board.is_none() || !self.link.is_calibrated()?)
    }

    /// Numbers the electrodes as the wires are, in the skin's text and on the board; gives what speaks against it.
    pub(super) fn reorder(&mut self, order: &Arrangement) -> anyhow::Result<Option<Finding>> {
        let told = order::told(order);
        let found = |advice: String| Some(Finding { what: told.clone(), advice });
        if !self.may_replace()? {
            let advice = "the board's patch was calibrated and is kept: exchange the wires, or set `electrodes.first` and \
                          `electrodes.direction`, build, flash and calibrate anew";
            return Ok(found(advice.to_owned()));
        }
        if !self.person.says_yes(&format!("{told}: build and flash a patch that knows?"))? {
            return Ok(found("exchange the wires, or let the patch be corrected".to_owned()));
        }
        match order::reordered(&self.text, &self.args.skin, &self.skin, order) {
            Ok((text, skin)) => {
                self.take(text, skin);
                self.flash().map(|()| None)
            }
            Err(error) => Ok(found(format!("{error:#}"))),
        }
    }

    /// Lowers the current in the skin's text, and on the board, to `amplitude`, A.
    pub(super) fn lower_current(&mut self, amplitude: f32) -> anyhow::Result<()> {
        let mut document: DocumentMut = self.text.parse().context("the skin file is no TOML")?;
        let drive = document.get_mut("drive").and_then(Item::as_table_like_mut);
        let drive = drive.with_context(|| format!("{}: there is no table `drive`", self.in_file()))?;
        drive.insert("amplitude", value(format!("{:.4} mA", 1e3 * amplitude)));
        let text = document.to_string();
        let skin = Skin::parse(&self.args.skin, &text)?.made()?;
        self.take(text, skin);
        self.flash()
    }

    fn take(&mut self, text: String, skin: Skin) {
        (self.text, self.skin, self.built) = (text, skin, None);
    }

    pub(super) fn is_corrected(&self) -> bool {
        self.text != self.written
    }

    /// The fields of the skin file that were corrected, with what they are now.
    pub(super) fn corrected_fields(&self) -> Vec<String> {
        let read = |text: &str| text.parse::<DocumentMut>().unwrap_or_default();
        let [before, after] = [&self.written, &self.text].map(|text| read(text));
        let fields = [
            ("electrodes", "first"),
            ("electrodes", "direction"),
            ("electrodes", "positions"),
            ("electrodes", "width"),
            ("electrodes", "contact_impedance"),
            ("drive", "amplitude"),
        ];
        let changed = fields.into_iter().filter_map(|(table, field)| {
            let [old, new] = [&before, &after].map(|text| {
                let item = text.get(table).and_then(|table| table.get(field));
                item.map(|item| item.to_string().trim().to_owned())
            });
            let new = new.filter(|new| Some(new) != old.as_ref())?;
            Some(format!("`{table}.{field}` = {new}"))
        });
        changed.collect()
    }
}
