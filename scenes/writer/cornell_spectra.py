"""The Cornell box's measured paints and lamp in linear Rec.709.

Reflectances and the lamp's spectrum are Cornell University's published measurements
(https://www.graphics.cornell.edu/online/box/data.html), 400 to 700 nm.
Colour-matching functions are the analytic fit of Wyman, Sloan, Shirley, "Simple Analytic
Approximations to the CIE XYZ Color Matching Functions" (JCGT 2(2), 2013), table 1, multi-lobe.
A paint becomes RGB as it looks under D65, Rec.709's white, so that a grey paint has r = g = b; each
channel is divided by that of a perfect white, which also cancels the fit's small white-point error.
The lamp becomes RGB without any adaptation: XYZ = integral of L cmf / integral of y-bar.
"""
import math

WHITE = """.343 .445 .551 .624 .665 .687 .708 .723 .715 .710 .745 .758 .739 .767 .777 .765 .751 .745 .748 .729
.745 .757 .753 .750 .746 .747 .735 .732 .739 .734 .725 .721 .733 .725 .732 .743 .744 .748 .728 .716 .733 .726
.713 .740 .754 .764 .752 .736 .734 .741 .740 .732 .745 .755 .751 .744 .731 .733 .744 .731 .712 .708 .729 .730
.727 .707 .703 .729 .750 .760 .751 .739 .724 .730 .740 .737"""
GREEN = """.092 .096 .098 .097 .098 .095 .095 .097 .095 .094 .097 .098 .096 .101 .103 .104 .107 .109 .112 .115
.125 .140 .160 .187 .229 .285 .343 .390 .435 .464 .472 .476 .481 .462 .447 .441 .426 .406 .373 .347 .337 .314
.285 .277 .266 .250 .230 .207 .186 .171 .160 .148 .141 .136 .130 .126 .123 .121 .122 .119 .114 .115 .117 .117
.118 .120 .122 .128 .132 .139 .144 .146 .150 .152 .157 .159"""
RED = """.040 .046 .048 .053 .049 .050 .053 .055 .057 .056 .059 .057 .061 .061 .060 .062 .062 .062 .061 .062
.060 .059 .057 .058 .058 .058 .056 .055 .056 .059 .057 .055 .059 .059 .058 .059 .061 .061 .063 .063 .067 .068
.072 .080 .090 .099 .124 .154 .192 .255 .287 .349 .402 .443 .487 .513 .558 .584 .620 .606 .609 .651 .612 .610
.650 .638 .627 .620 .630 .628 .642 .639 .657 .639 .635 .642"""
LAMP = (0.0, 8.0, 15.6, 18.4)  # 400, 500, 600, 700 nm, published in arbitrary units, taken as nits here
LIGHT_REFLECTANCE = 0.78
# CIE standard illuminant D65, every 10 nm from 400 nm.
D65 = (82.75, 91.49, 93.43, 86.68, 104.86, 117.01, 117.81, 114.86, 115.92, 108.81, 109.35, 107.80, 104.79, 107.69,
       104.41, 104.05, 100.00, 96.33, 95.79, 88.69, 90.01, 89.60, 87.70, 83.29, 83.70, 80.03, 80.21, 82.28, 78.28,
       69.72, 71.61)
REC709_FROM_XYZ = ((3.2404542, -1.5371385, -0.4985314), (-0.9692660, 1.8760108, 0.0415560),
                   (0.0556434, -0.2040259, 1.0572252))


def color_matching(nm):
    def lobe(mean, below, above):
        return math.exp(-0.5 * ((nm - mean) / (below if nm < mean else above)) ** 2)
    return (1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) - 0.065 * lobe(501.1, 20.4, 26.2),
            0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1),
            1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8))


def spectrum(values):
    """Evenly spaced samples over 400..700 nm, linearly interpolated."""
    def at(nm):
        x = (nm - 400) / 300 * (len(values) - 1)
        i = min(int(x), len(values) - 2)
        return values[i] + (x - i) * (values[i + 1] - values[i])
    return at


def rec709(power):
    xyz, y_sum = [0.0, 0.0, 0.0], 0.0
    for nm in range(400, 701):
        cmf = color_matching(nm)
        y_sum += cmf[1]
        xyz = [s + power(nm) * c for s, c in zip(xyz, cmf)]
    return [sum(m * s / y_sum for m, s in zip(row, xyz)) for row in REC709_FROM_XYZ]


def paint(table):
    reflectance, daylight = spectrum([float(x) for x in table.split()]), spectrum(D65)
    under, white = rec709(lambda nm: reflectance(nm) * daylight(nm)), rec709(daylight)
    return tuple(round(r / w, 4) for r, w in zip(under, white))


def lamp():
    return tuple(round(c, 4) for c in rec709(spectrum(LAMP)))


if __name__ == "__main__":
    for name, table in (("white", WHITE), ("green", GREEN), ("red", RED)):
        assert len(table.split()) == 76
        print(name, paint(table))
    print("lamp", lamp())
