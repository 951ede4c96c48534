use super::*;
use crate::chip::tests::bus::Bus;

fn amplifier(fields: &[(&str, u32)]) -> Bus<Opamp> {
    let mut bus = Bus::new(Opamp::new("OPAMP2"));
    bus.fields("CSR", fields);
    bus
}

#[test]
fn a_follower_and_each_gain_around_vinm0() {
    let follower = amplifier(&[("OPAMPEN", 1), ("VM_SEL", 3), ("VP_SEL", 2)]);
    assert_eq!(follower.model.setting(), OpampSetting::Amplifier { input: 2, gain: 1.0 });
    for (code, gain) in [(8, 2.0), (9, 4.0), (10, 8.0), (11, 16.0), (12, 32.0), (13, 64.0)] {
        let bus = amplifier(&[("OPAMPEN", 1), ("VM_SEL", 2), ("PGA_GAIN", code)]);
        assert_eq!(bus.model.setting(), OpampSetting::Amplifier { input: 0, gain });
    }
}

#[test]
fn it_reaches_the_converter_only_when_on_and_told_to() {
    for (is_on, inside) in [(0, 1), (1, 0), (1, 1)] {
        let bus = amplifier(&[("OPAMPEN", is_on), ("VM_SEL", 3), ("OPAINTOEN", inside)]);
        assert_eq!(bus.model.reaches_converter(), is_on + inside == 2);
        assert_eq!(bus.model.setting() == OpampSetting::Off, is_on == 0);
    }
}

#[test]
fn what_the_world_could_not_know_is_refused() {
    let mut bus = amplifier(&[]);
    let register = bus.model.bank().map.register("CSR");
    let with = |fields: &[(&str, u32)]| {
        fields
            .iter()
            .fold(register.mask("OPAMPEN"), |value, &(field, content)| register.with(value, field, content))
    };
    for (fields, message) in [
        (&[("VM_SEL", 0)][..], "VM_SEL = 0"),
        (&[("VM_SEL", 2), ("PGA_GAIN", 3)], "8 to 13"),
        (&[("VM_SEL", 2), ("PGA_GAIN", 25)], "8 to 13"),
        (&[("VM_SEL", 2), ("PGA_GAIN", 14)], "reserved"),
        (&[("VM_SEL", 3), ("CALON", 1)], "CALON"),
        (&[("VM_SEL", 3), ("USERTRIM", 1)], "USERTRIM"),
    ] {
        let refusal = bus.refused("CSR", with(fields));
        assert!(refusal.contains(message), "{refusal}");
        assert_eq!(bus.model.setting(), OpampSetting::Off);
    }
    assert!(bus.refused("TCMR", 8).contains("TCMR"));
    bus.write("TCMR", 0);
}

#[test]
fn a_locked_amplifier_stays_as_it_is() {
    let mut bus = amplifier(&[("OPAMPEN", 1), ("VM_SEL", 3), ("LOCK", 1)]);
    assert!(bus.refused("CSR", 0).contains("LOCK"));
    bus.model.reset();
    bus.write("CSR", 0);
}
