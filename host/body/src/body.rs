//! Body: what all keepers tell, as one view.

use crate::{
    contact::{SkinContact, Wrench, on_link},
    driven::Driven,
    file::Patch,
    keeper::{Phase, State, Told},
    placed::PlacedSkin,
};
use dermatome_link::{ScanFrame, assemble::HealthReport, pose::Pose};
use dermatome_messages::clock::{Clock, Jitter};
use dermatome_shared::{
    pipeline::reflex::Reflexes,
    protocol::{FrameStamp, PackedImage},
};

/// A robot's skins as they are now.
pub struct Body {
    senses: Vec<Sense>,
}

/// One skin as it is now.
#[derive(Debug)]
pub struct Sense {
    /// Its name on this body.
    pub name: String,
    /// The link that it lies on.
    pub link: String,
    /// How its board stands.
    pub state: State,
    /// The last frame's contacts; none while they would be stale.
    pub report: Option<Report>,
    /// How its board drives it; none before that is known.
    pub driven: Option<Driven>,
    /// What its board said last about electrodes and itself, where it is asked to; none while that would be stale.
    pub health: Option<HealthReport>,
    /// What the patch's reflexes say; none without reflexes, and while that would be stale.
    pub reflexes: Option<Reflexes>,
    /// Frames that have come.
    pub frames: u64,
    /// Frames that have not come, in this stream and those before.
    pub missing: u64,
    /// Times that the board was lost.
    pub losses: u64,
    pose: Pose,
    skin: Option<PlacedSkin>,
    clock: Clock,
    /// Frames that had not come when this stream began.
    missing_before: u64,
}

/// The contacts of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The frame.
    pub at: FrameStamp,
    /// When the scan ended, by this computer's clock, ns since 1970.
    pub time_ns: u64,
    /// When the frame came, likewise.
    pub received_ns: u64,
    /// In the link's frame, strongest first.
    pub contacts: Vec<SkinContact>,
    /// The image that they were found in, where it came as well.
    pub image: Option<PackedImage>,
}

impl Report {
    /// Whether nothing is known to be wrong with the contacts: no fault of board, electrodes or reference.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.at.flags.leaves_contacts_valid()
    }
}

impl Body {
    /// Of these patches, none of whose boards has been heard of.
    #[must_use]
    pub fn new(patches: &[Patch]) -> Self {
        let sense = |patch: &Patch| Sense::new(patch.name.clone(), patch.pose.clone());
        Self { senses: patches.iter().map(sense).collect() }
    }

    /// Adds a skin that another computer serves; gives its place among the senses. What it says is told with
    /// [`Body::stand`] and [`Body::report`].
    pub fn join(&mut self, name: &str, link: &str) -> usize {
        let pose = Pose { link: link.to_owned(), position: [0.0; 3], orientation: [0.0, 0.0, 0.0, 1.0] };
        self.senses.push(Sense::new(name.to_owned(), pose));
        self.senses.len() - 1
    }

    /// The board of a skin stands so from now on.
    pub fn stand(&mut self, index: usize, state: State) {
        if let Some(sense) = self.senses.get_mut(index) {
            sense.stand(state);
        }
    }

    /// Takes the contacts of a frame as another computer made them; `missing` frames have not come there.
    pub fn report(&mut self, index: usize, report: Report, missing: u64) {
        if let Some(sense) = self.senses.get_mut(index) {
            (sense.frames, sense.missing) = (sense.frames + 1, missing);
            sense.report = Some(report);
        }
    }

    /// The skins, as in the body file.
    #[must_use]
    pub fn senses(&self) -> &[Sense] {
        &self.senses
    }

    /// Takes what the keeper of a patch, by its place in the body file, told; gives the frame's contacts, where it was one
    /// with contacts.
    pub fn take(&mut self, index: usize, told: &Told) -> Option<&Report> {
        let sense = self.senses.get_mut(index)?;
        match told {
            Told::State(state) => {
                sense.stand(state.clone());
                None
            }
            Told::Patch { tables, .. } => {
                sense.skin = Some(PlacedSkin::new(tables, &sense.pose));
                None
            }
            Told::Driven(driven) => {
                sense.driven = Some(**driven);
                None
            }
            Told::NotDriven { .. } | Told::GivenUp(_) | Told::Reference(_) => None,
            Told::Frame { frame, received_ns, missing } => {
                sense.frames += 1;
                sense.missing = sense.missing_before + missing;
                sense.frame(frame, *received_ns)
            }
        }
    }

    /// What presses on a link, about its origin; none where no skin on it reports, or tells forces.
    #[must_use]
    pub fn wrench(&self, link: &str) -> Option<Wrench> {
        let on_link = self.senses.iter().filter(|sense| sense.link == link);
        let reports = on_link.filter_map(|sense| sense.report.as_ref());
        let mut wrenches = reports.filter_map(Report::wrench);
        let first = wrenches.next()?;
        Some(wrenches.fold(first, Wrench::and))
    }
}

impl Report {
    /// What its contacts do to the link, about its origin; none where one of them has no force.
    #[must_use]
    pub fn wrench(&self) -> Option<Wrench> {
        let mut wrenches = self.contacts.iter().map(SkinContact::on_link);
        wrenches.try_fold(Wrench::default(), |sum, wrench| Some(sum.and(wrench?)))
    }
}

impl Sense {
    /// Of which nothing has been heard.
    fn new(name: String, pose: Pose) -> Self {
        Self {
            name,
            link: pose.link.clone(),
            state: State { phase: Phase::NoBoard, text: String::new() },
            report: None,
            driven: None,
            health: None,
            reflexes: None,
            frames: 0,
            missing: 0,
            losses: 0,
            pose,
            skin: None,
            clock: Clock::default(),
            missing_before: 0,
        }
    }

    /// How late frames come.
    #[must_use]
    pub fn jitter(&self) -> Option<Jitter> {
        self.clock.jitter()
    }

    /// Its pixels on its link; none before its board has shown its patch.
    #[must_use]
    pub fn placed(&self) -> Option<&PlacedSkin> {
        self.skin.as_ref()
    }

    fn stand(&mut self, state: State) {
        if state.phase != Phase::Live {
            self.losses += u64::from(state.phase == Phase::Lost && self.state.phase != Phase::Lost);
            // What a board said before is over.
            (self.report, self.health, self.reflexes) = (None, None, None);
        } else if self.state.phase != Phase::Live {
            self.missing_before = self.missing;
        }
        self.state = state;
    }

    fn frame(&mut self, frame: &ScanFrame, received_ns: u64) -> Option<&Report> {
        if frame.health.is_some() {
            self.health.clone_from(&frame.health);
        }
        self.reflexes.clone_from(&frame.reflexes);
        let (at, contacts, image) = (frame.at?, frame.contacts.as_ref()?, frame.image.clone());
        let contacts = on_link(self.skin.as_ref()?, contacts, image.as_ref());
        let time_ns = self.clock.host_time(at.timestamp_us, received_ns);
        self.report = Some(Report { at, time_ns, received_ns, contacts, image });
        self.report.as_ref()
    }
}
