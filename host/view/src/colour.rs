//! Colour: relative conductivity to red, green and blue.

/// Colours of -1, 0 and 1: the ends of ColorBrewer's RdBu scale, which colour-blind people can
/// tell apart, around white.
const BLUE: [u8; 3] = [33, 102, 172];
const WHITE: [u8; 3] = [255, 255, 255];
const RED: [u8; 3] = [178, 24, 43];

/// Colour of `value`, a relative conductivity change: white at zero, towards red upwards, towards
/// blue downwards, full at `maximum` and beyond.
///
/// White where the value is not a number or the maximum is not above zero.
#[must_use]
pub fn diverging(value: f64, maximum: f64) -> [u8; 3] {
    let part = share(value, maximum);
    let end = if part > 0.0 { RED } else { BLUE };
    std::array::from_fn(|i| {
        let (from, to) = (f64::from(WHITE[i]), f64::from(end[i]));
        (from + (to - from) * part.abs()).round() as u8
    })
}

/// Colours of 0 to 1 for quantities without a sign: ColorBrewer's YlGnBu scale, light to dark.
const LIGHT_TO_DARK: [[u8; 3]; 5] =
    [[255, 255, 204], [161, 218, 180], [65, 182, 196], [44, 127, 184], [37, 52, 148]];

/// Colour of a share, from light at 0 to dark at 1 and beyond; light where it is not a number.
#[must_use]
pub fn sequential(share: f64) -> [u8; 3] {
    let last = LIGHT_TO_DARK.len() - 1;
    let place = share.clamp(0.0, 1.0).max(0.0) * last as f64;
    let index = (place as usize).min(last - 1);
    let part = place - index as f64;
    std::array::from_fn(|i| {
        let [from, to] = [index, index + 1].map(|index| f64::from(LIGHT_TO_DARK[index][i]));
        (from + (to - from) * part).round() as u8
    })
}

/// `value / maximum`, within -1 to 1; zero where that is not a number.
pub(super) fn share(value: f64, maximum: f64) -> f64 {
    let part = value / maximum;
    if maximum > 0.0 && !part.is_nan() { part.clamp(-1.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_red_down_is_blue_and_zero_is_white() {
        assert_eq!(diverging(0.0, 0.1), WHITE);
        assert_eq!(diverging(0.1, 0.1), RED);
        assert_eq!(diverging(7.0, 0.1), RED);
        assert_eq!(diverging(-0.1, 0.1), BLUE);
        assert_eq!(diverging(0.05, 0.1), [217, 140, 149]);
        assert_eq!(diverging(f64::NEG_INFINITY, 1.0), BLUE);
    }

    #[test]
    fn shares_go_from_light_to_dark_through_the_scale() {
        assert_eq!(sequential(0.0), LIGHT_TO_DARK[0]);
        assert_eq!(sequential(-1.0), LIGHT_TO_DARK[0]);
        assert_eq!(sequential(f64::NAN), LIGHT_TO_DARK[0]);
        assert_eq!(sequential(0.5), LIGHT_TO_DARK[2]);
        assert_eq!(sequential(0.125), [208, 237, 192]);
        assert_eq!(sequential(1.0), LIGHT_TO_DARK[4]);
        assert_eq!(sequential(7.0), LIGHT_TO_DARK[4]);
    }

    #[test]
    fn what_cannot_be_scaled_is_white() {
        for (value, maximum) in [(f64::NAN, 1.0), (1.0, 0.0), (1.0, -1.0), (1.0, f64::NAN)] {
            assert_eq!(diverging(value, maximum), WHITE);
        }
    }
}
