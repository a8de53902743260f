// Colour maps by the names that matplotlib gave them.
//
// None is a copied table. Each is an approximation by the fewest straight pieces, fitted by least squares, whose
// largest error against the map of that name (matplotlib 3.6) is 0.025 in any component. The maps are due to: S. van
// der Walt and N. Smith (viridis, plasma, inferno, magma; CC0), J. Nunez, C. Anderton and R. Renslow (cividis), A.
// Mikhailov (turbo), K. Moreland (coolwarm), C. Brewer (the names in capitals, but CMRmap and Wistia), D. Green
// (cubehelix), B. Bechtold (twilight). Left out: qualitative maps, and those too rugged for so few pieces (flag,
// gist_ncar, gist_stern, nipy_spectral, prism).
#include "classify/presets.h"

namespace chiaro {

// clang-format off
std::span<const ColorMapRow> color_map_rows() {
    static constexpr ColorMapRow rows[] = {
        {"viridis", "0:470257 0.161:463985 0.384:2a7590 0.596:1ca787 0.745:56c966 0.949:dce515 1:fee623"},
        {"plasma", "0:110788 0.094:40039e 0.251:7f00ac 0.431:bc3389 0.694:f4804c 0.878:ffc426 1:f0f925"},
        {"inferno", "0:000000 0.098:140c3a 0.192:3f096c 0.392:91236c 0.596:df4c3c 0.78:ff9a01 0.882:f8ce34 "
         "0.949:f0ee70 1:faffa6"},
        {"magma", "0:000000 0.118:181142 0.22:440f7c 0.443:9e2e82 0.62:e64c65 0.714:fa7659 0.831:ffae75 1:fcfdbd"},
        {"cividis", "0:00234d 0.082:013172 0.18:33416a 0.631:9c9479 0.843:d4c161 1:ffe634"},
        {"turbo", "0:321340 0.078:434cba 0.157:4980fb 0.22:36a9fe 0.31:13dcc6 0.369:29f19f 0.455:7dff54 "
         "0.525:b7fb32 0.651:fac63c 0.741:ff8625 0.855:e03704 1:800101"},
        {"gray", "0:000000 1:ffffff"},
        {"bone", "0:000000 0.365:515171 0.745:a6c6c6 1:ffffff"},
        {"hot", "0:0b0000 0.365:ff0000 0.745:ffff00 1:ffffff"},
        {"cool", "0:00ffff 1:ff00ff"},
        {"jet", "0:00007f 0.11:0000ff 0.125:0001ff 0.341:00dcff 0.373:12ffe4 0.639:eeff09 0.659:ffed00 0.89:ff1300 "
         "0.91:e80000 1:800000"},
        {"coolwarm", "0:394dc4 0.188:779cfb 0.353:b1ceff 0.51:e2dfdb 0.678:fbb697 0.831:ea785b 0.957:c53332 "
         "1:b40526"},
        {"hsv", "0:ff0000 0.169:fffe00 0.337:02ff00 0.51:00fdff 0.678:0200ff 0.847:ff00fe 1:ff0018"},
        {"rainbow", "0:7f04ff 0.251:00baee 0.412:53facc 0.569:a2ffa1 0.749:ffbb63 1:ff0400"},
        {"spring", "0:ff00ff 1:ffff00"},
        {"summer", "0:007f66 1:ffff66"},
        {"autumn", "0:ff0000 1:ffff00"},
        {"winter", "0:0000ff 1:00ff7f"},
        {"copper", "0:000000 0.808:ffa166 1:ffc77f"},
        {"afmhot", "0:000000 0.247:7e0000 0.502:ff8001 0.749:ffff7f 1:ffffff"},
        {"binary", "0:ffffff 1:000000"},
        {"Blues", "0:f8faff 0.294:bbd7eb 0.545:5aa6d0 0.808:1162ad 1:05306f"},
        {"BrBG", "0:543005 0.102:8d510a 0.2:c0842e 0.369:f2e2b0 0.498:f7f5f6 0.608:c3e9e3 0.702:7bcbc0 0.886:026c64 "
         "1:003c30"},
        {"brg", "0:0000ff 0.498:ff0001 1:00ff00"},
        {"BuGn", "0:f8fcff 0.235:d1eeec 0.498:67c3a6 0.624:41ae76 0.753:228a44 0.875:006d2c 1:00441b"},
        {"BuPu", "0:fcffff 0.424:93b2d5 0.871:821382 1:4d0049"},
        {"bwr", "0:0000ff 0.498:feffff 1:ff0000"},
        {"CMRmap", "0:000000 0.125:262680 0.251:4d26bf 0.373:983381 0.502:ff4025 0.627:e58100 0.749:e6bf19 "
         "0.875:e5e57f 1:ffffff"},
        {"cubehelix", "0:020000 0.086:1b102a 0.176:17324f 0.282:166248 0.388:497b2b 0.494:9e7941 0.596:d47b90 "
         "0.702:d19cdf 0.8:becbf6 0.898:cfefed 1:fffffb"},
        {"gist_earth", "0:000000 0.004:01002b 0.027:050573 0.275:2e8181 0.455:479949 0.69:b7b85e 0.788:c0a266 "
         "0.894:dfb9aa 1:fdf8fb"},
        {"gist_gray", "0:000000 1:ffffff"},
        {"gist_heat", "0:000000 0.502:c00000 0.667:ff5500 0.749:ff7f00 1:ffffff"},
        {"gist_rainbow", "0:ff0028 0.031:ff0200 0.216:ffff00 0.4:00ff00 0.584:00fffe 0.769:0001ff 0.953:fd00ff "
         "1:ff00c0"},
        {"gist_yarg", "0:ffffff 1:000000"},
        {"GnBu", "0:f9fcf0 0.349:b3e3b5 0.624:4eb4d2 0.875:0867ac 1:084181"},
        {"gnuplot", "0:030000 0.012:200013 0.078:49007b 0.153:6401d5 0.22:7803fe 0.286:8906fd 0.376:9d0eb9 "
         "0.502:b51d00 0.761:df6a00 1:fff900"},
        {"gnuplot2", "0:000000 0.251:0000ff 0.424:8a01fe 0.569:ff4cb3 0.922:ffff00 1:ffffff"},
        {"Greens", "0:f9fdf7 0.208:d4efcd 0.467:82cb7f 0.604:48af61 0.878:006c2c 1:00441b"},
        {"Greys", "0:ffffff 0.298:d3d3d3 1:030303"},
        {"ocean", "0:007f00 0.333:000055 0.667:0080aa 1:ffffff"},
        {"Oranges", "0:fff5ed 0.192:fdddb9 0.494:fe8f3b 0.71:e45001 1:7c2504"},
        {"OrRd", "0:fffaeb 0.345:fdc488 0.502:fc8d5b 0.631:f06244 0.867:b80100 1:7e0000"},
        {"pink", "0:1e0101 0.024:3c2323 0.122:764b4b 0.349:c07e7d 0.722:e7e7b1 1:ffffff"},
        {"PiYG", "0:8e0152 0.102:c61c7d 0.208:e07eb4 0.353:fad1e9 0.498:f9f7f9 0.616:e2f6c5 0.812:79ba37 1:236414"},
        {"PRGn", "0:40004a 0.086:6e267e 0.314:c9b0d5 0.498:fcf9fa 0.671:bae5b2 0.8:5baf61 0.898:1c7938 1:00441b"},
        {"PuBu", "0:fff9fc 0.259:d1d0e6 0.506:70a8ce 0.749:0373b2 1:033b5e"},
        {"PuBuGn", "0:fff5fa 0.267:cfcfe5 0.627:3391c1 0.757:018285 1:014b32"},
        {"PuOr", "0:813804 0.196:e07e0f 0.314:ffc171 0.498:f9fbfa 0.686:b8b7d8 0.914:4d2381 1:2e004a"},
        {"PuRd", "0:f8f4f9 0.11:e7e3f0 0.369:c998ca 0.612:ea3192 0.745:cf1157 0.878:970042 1:67001f"},
        {"Purples", "0:fefcfd 0.247:dcdcec 0.616:827eba 1:3e007b"},
        {"RdBu", "0:670020 0.102:b31929 0.267:ec906c 0.388:fdd7c0 0.502:f8f8f8 0.639:bddceb 0.804:4293c3 "
         "0.902:2065ab 1:053061"},
        {"RdGy", "0:690020 0.118:bc232b 0.318:f8b38c 0.494:ffffff 0.682:c4c4c4 1:191919"},
        {"RdPu", "0:fff8f4 0.282:fbbfbd 0.49:f86ea4 0.62:df3697 0.749:ae017f 1:48006c"},
        {"RdYlBu", "0:a50024 0.125:e43d2c 0.31:ffb665 0.49:ffffba 0.604:dff4f9 0.753:8dc5de 0.894:4679b6 1:313695"},
        {"RdYlGn", "0:a50025 0.114:de372a 0.255:fc9252 0.384:feda83 0.498:ffffbd 0.671:bae370 0.906:1a9851 1:006736"},
        {"Reds", "0:fff4f1 0.125:fde1cf 0.518:fc6441 0.694:de2322 0.878:a30d14 1:67010d"},
        {"seismic", "0:00004d 0.251:0000ff 0.498:feffff 0.749:ff0101 1:800000"},
        {"Spectral", "0:9e0142 0.098:d43d4f 0.204:f67043 0.357:ffcf76 0.498:feffbe 0.6:e8f69a 0.804:66c1a7 "
         "0.898:3289bd 1:5e4fa2"},
        {"terrain", "0:333399 0.149:0098ff 0.251:01cd66 0.502:ffff99 0.749:7f5c54 1:ffffff"},
        {"twilight", "0:e3dae4 0.043:d1d6d8 0.145:84acc2 0.235:617fbf 0.357:5d359f 0.424:4c1367 0.502:2a1033 "
         "0.624:721a51 0.725:ac464e 0.827:c58664 0.957:dbd2cc 1:e3dae4"},
        {"twilight_shifted", "0:2e1133 0.075:4b1366 0.141:5d349e 0.259:617cbe 0.349:81aac1 0.467:d9d9dc "
         "0.522:e1dadf 0.655:c79371 0.737:b95c51 0.851:862351 0.929:4f1345 1:2d1234"},
        {"Wistia", "0:e4ff7a 0.251:ffe81a 0.498:ffbe00 1:fd8000"},
        {"YlGn", "0:ffffe2 0.176:f0f9ae 0.431:98d586 0.62:43ab5c 0.875:016634 1:00462b"},
        {"YlGnBu", "0:ffffd9 0.125:edf8b1 0.247:c8e8b3 0.459:52bec2 0.612:1e95c2 0.875:253293 1:081e58"},
        {"YlOrBr", "0:ffffe5 0.22:feeb9c 0.439:ffb036 0.612:f07415 0.761:c84802 1:662306"},
        {"YlOrRd", "0:ffffcd 0.302:fecc61 0.498:ff8c3a 0.714:ef261e 0.867:c00024 1:810027"},
    };
    return rows;
}
// clang-format on

}  // namespace chiaro
