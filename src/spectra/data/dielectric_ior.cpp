#include "spectra/data/dielectric_ior.h"

namespace nacre::data {
namespace {

constexpr std::string_view schott = "Schott optical glass catalogue of 2017";
constexpr std::string_view ghosh = "Ghosh 1999, Opt. Commun. 163, 95";
constexpr std::string_view malitson_dodge = "Malitson and Dodge 1972, J. Opt. Soc. Am. 62, 1405; "
                                            "coefficients: Dodge 1986, Handbook of Laser Science and "
                                            "Technology IV, p. 30";
constexpr std::string_view sultanova =
    "Sultanova, Kasarova, Nikolov 2009, Acta Phys. Pol. A 116, 585; one-term fit of refractiveindex.info";

constexpr double c_n_bk7[] = {0,          1.03961212, 0.00600069867, 0.231792344, 0.0200179144,
                              1.01046945, 103.560653};
constexpr double c_n_k5[] = {0, 1.08511833, 0.00661099503, 0.199562005, 0.024110866, 0.930511663, 111.982777};
constexpr double c_n_fk51a[] = {0,           0.971247817, 0.00472301995, 0.216901417, 0.0153575612,
                                0.904651666, 168.68133};
constexpr double c_n_bak4[] = {0,           1.28834642, 0.00779980626, 0.132817724, 0.0315631177,
                               0.945395373, 105.965875};
constexpr double c_n_baf10[] = {0,          1.5851495, 0.00926681282, 0.143559385, 0.0424489805,
                                1.08521269, 105.613573};
constexpr double c_f2[] = {0, 1.34533359, 0.00997743871, 0.209073176, 0.0470450767, 0.937357162, 111.886764};
constexpr double c_sf5[] = {0, 1.46141885, 0.0111826126, 0.247713019, 0.0508594669, 0.949995832, 112.041888};
constexpr double c_sf10[] = {0, 1.61625977, 0.0127534559, 0.259229334, 0.0581983954, 1.07762317, 116.60768};
constexpr double c_sf11[] = {0, 1.73848403, 0.0136068604, 0.311168974, 0.0615960463, 1.17490871, 121.922711};
constexpr double c_n_sf11[] = {0, 1.73759695, 0.013188707, 0.313747346, 0.0623068142, 1.89878101, 155.23629};
constexpr double c_lasfn9[] = {0, 1.97888194, 0.0118537266, 0.320435298, 0.052738177, 1.92900751, 166.25654};
constexpr double c_n_lasf9[] = {0,          2.00029547, 0.0121426017, 0.298926886, 0.0538736236,
                                1.80691843, 156.530829};
constexpr double c_n_sf66[] = {0, 2.0245976, 0.0147053225, 0.470187196, 0.0692998276, 2.59970433, 161.817601};
constexpr double c_fused_silica[] = {0, 0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161};
constexpr double c_quartz_o[] = {0.28604141, 1.07044083, 0.0100585997, 1.10202242, 100};
constexpr double c_quartz_e[] = {0.28851804, 1.09509924, 0.0102101864, 1.15662475, 100};
constexpr double c_calcite_o[] = {0.73358749, 0.96464345, 0.0194325203, 1.82831454, 120};
constexpr double c_calcite_e[] = {0.35859695, 0.82427830, 0.0106689543, 0.14429128, 120};
constexpr double c_sapphire_o[] = {0, 1.4313493, 0.0726631, 0.65054713, 0.1193242, 5.3414021, 18.028251};
constexpr double c_sapphire_e[] = {0, 1.5039759, 0.0740288, 0.55069141, 0.1216529, 6.5927379, 20.072248};
constexpr double c_rutile_o[] = {5.913, 0.2441, 0.0803};
constexpr double c_rutile_e[] = {7.197, 0.3322, 0.0843};
constexpr double c_magnesium_fluoride_o[] = {0,          0.48755108, 0.04338408, 0.39875031,
                                             0.09461442, 2.3120353,  23.793604};
constexpr double c_magnesium_fluoride_e[] = {0,          0.41344023, 0.03684262, 0.50497499,
                                             0.09076162, 2.4904862,  23.771995};
constexpr double c_calcium_fluoride[] = {0,         0.5675888, 0.050263605, 0.4710914,
                                         0.1003909, 3.8484723, 34.649040};
constexpr double c_lithium_fluoride[] = {0, 0.92549, 0.07376, 6.96747, 32.790};
constexpr double c_sodium_chloride[] = {0.00055, 0.19800, 0.050, 0.48398, 0.100, 0.38696, 0.128, 0.25998,
                                        0.158,   0.08796, 40.50, 3.17064, 60.98, 0.30038, 120.34};
constexpr double c_yag[] = {0, 2.28200, 0.01185, 3.27644, 282.734};
constexpr double c_diamond[] = {0, 0.3306, 0.1750, 4.3356, 0.1060};
constexpr double c_water[] = {0,
                              5.684027565E-1,
                              5.101829712E-3,
                              1.726177391E-1,
                              1.821153936E-2,
                              2.086189578E-2,
                              2.620722293E-2,
                              1.130748688E-1,
                              1.069792721E1};
constexpr double c_ethanol[] = {1.35265, 0.00306, 0.00002};
constexpr double c_acetone[] = {1.34979, 0.00306, 0.00006};
constexpr double c_pmma[] = {0, 1.1819, 0.011313};
constexpr double c_polystyrene[] = {0, 1.4435, 0.020216};
constexpr double c_polycarbonate[] = {0, 1.4182, 0.021304};
constexpr double c_air[] = {0.05792105, 238.0185, 0.00167917, 57.362};

constexpr DielectricIorRow rows[] = {
    {"n-bk7,bk7", DispersionForm::sellmeier, c_n_bk7, 300, 2500, schott},
    {"n-k5,k5", DispersionForm::sellmeier, c_n_k5, 310, 2500, schott},
    {"n-fk51a,fk51a", DispersionForm::sellmeier, c_n_fk51a, 290, 2500, schott},
    {"n-bak4,bak4", DispersionForm::sellmeier, c_n_bak4, 334, 2500, schott},
    {"n-baf10,baf10", DispersionForm::sellmeier, c_n_baf10, 350, 2500, schott},
    {"f2", DispersionForm::sellmeier, c_f2, 320, 2500, schott},
    {"sf5", DispersionForm::sellmeier, c_sf5, 350, 2500, schott},
    {"sf10", DispersionForm::sellmeier, c_sf10, 380, 2500, schott},
    {"sf11", DispersionForm::sellmeier, c_sf11, 390, 2500, schott},
    {"n-sf11", DispersionForm::sellmeier, c_n_sf11, 370, 2500, schott},
    {"lasfn9", DispersionForm::sellmeier, c_lasfn9, 365, 2500, schott},
    {"n-lasf9,lasf9", DispersionForm::sellmeier, c_n_lasf9, 365, 2500, schott},
    {"n-sf66", DispersionForm::sellmeier, c_n_sf66, 390, 2500, schott},
    {"fused silica,silica,fused quartz", DispersionForm::sellmeier_poles, c_fused_silica, 210, 6700,
     "Malitson 1965, J. Opt. Soc. Am. 55, 1205"},
    {"quartz-o", DispersionForm::sellmeier, c_quartz_o, 198, 2053.1, ghosh},
    {"quartz-e", DispersionForm::sellmeier, c_quartz_e, 198, 2053.1, ghosh},
    {"calcite-o", DispersionForm::sellmeier, c_calcite_o, 204, 2172, ghosh},
    {"calcite-e", DispersionForm::sellmeier, c_calcite_e, 204, 2172, ghosh},
    {"sapphire-o,sapphire", DispersionForm::sellmeier_poles, c_sapphire_o, 200, 5000, malitson_dodge},
    {"sapphire-e", DispersionForm::sellmeier_poles, c_sapphire_e, 200, 5000, malitson_dodge},
    {"rutile-o,rutile", DispersionForm::pole, c_rutile_o, 430, 1530, "Devore 1951, J. Opt. Soc. Am. 41, 416"},
    {"rutile-e", DispersionForm::pole, c_rutile_e, 430, 1530, "Devore 1951, J. Opt. Soc. Am. 41, 416"},
    {"magnesium fluoride-o,magnesium fluoride", DispersionForm::sellmeier_poles, c_magnesium_fluoride_o, 200,
     7000, "Dodge 1984, Appl. Opt. 23, 1980"},
    {"magnesium fluoride-e", DispersionForm::sellmeier_poles, c_magnesium_fluoride_e, 200, 7000,
     "Dodge 1984, Appl. Opt. 23, 1980"},
    {"calcium fluoride,fluorite", DispersionForm::sellmeier_poles, c_calcium_fluoride, 230, 9700,
     "Malitson 1963, Appl. Opt. 2, 1103"},
    {"lithium fluoride", DispersionForm::sellmeier_poles, c_lithium_fluoride, 100, 11000,
     "Li 1976, J. Phys. Chem. Ref. Data 5, 329"},
    {"sodium chloride,salt", DispersionForm::sellmeier_poles, c_sodium_chloride, 200, 30000,
     "Li 1976, J. Phys. Chem. Ref. Data 5, 329"},
    {"yag", DispersionForm::sellmeier, c_yag, 400, 5000, "Zelmon, Small, Page 1998, Appl. Opt. 37, 4933"},
    {"diamond", DispersionForm::sellmeier_poles, c_diamond, 226, 760, "Peter 1923, Z. Phys. 15, 358"},
    {"water", DispersionForm::sellmeier, c_water, 182, 1129,
     "Daimon and Masumura 2007, Appl. Opt. 46, 3811, 20 degrees, in vacuum"},
    {"ethanol", DispersionForm::cauchy, c_ethanol, 476.5, 830,
     "Rheims, Koeser, Wriedt 1997, Meas. Sci. Technol. 8, 601"},
    {"acetone", DispersionForm::cauchy, c_acetone, 476.5, 830,
     "Rheims, Koeser, Wriedt 1997, Meas. Sci. Technol. 8, 601"},
    {"pmma,acrylic glass", DispersionForm::sellmeier, c_pmma, 436.8, 1052, sultanova},
    {"polystyrene", DispersionForm::sellmeier, c_polystyrene, 436.8, 1052, sultanova},
    {"polycarbonate", DispersionForm::sellmeier, c_polycarbonate, 436.8, 1052, sultanova},
    {"air", DispersionForm::gas, c_air, 230, 1690,
     "Ciddor 1996, Appl. Opt. 35, 1566, dry, 15 degrees, 101325 Pa"}};

} // namespace

std::span<const DielectricIorRow> dielectric_ior_rows() { return rows; }

} // namespace nacre::data
