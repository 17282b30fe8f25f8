#pragma once
// Colour as FLIP sees it: linear light of the BT.709 primaries, opponent colours in which
// the eye's blur is applied, and CIE L*a*b*, Hunt-adjusted, in which differences are
// measured. Everything is relative to the white of the primaries (D65).
//
// Source: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild, "FLIP: A
// Difference Evaluator for Alternating Images" (2020), section 4.1.

namespace softfocus {

struct LinearColour {
  double red, green, blue;  ///< 0 to 1
};

/// YCxCz (Flohr and others 1993), linear in light: Y = 116 y - 16, Cx = 500 (x - y),
/// Cz = 200 (y - z), with x, y, z the tristimulus values over the white's.
struct OpponentColour {
  double y, cx, cz;
};

/// L* of 0 to 100, a* and b* times 0.01 L* (Hunt: colour fades in the dark).
struct HuntLab {
  double l, a, b;
};

OpponentColour to_opponent(const LinearColour& colour);

/// The way back; may leave 0 to 1.
LinearColour to_linear(const OpponentColour& colour);

HuntLab to_hunt_lab(const LinearColour& colour);

/// The distance for large differences of Abasi, Tehran and Fairchild (2020):
/// |L1 - L2| + sqrt((a1 - a2)^2 + (b1 - b2)^2).
double hyab(const HuntLab& one, const HuntLab& other);

}  // namespace softfocus
