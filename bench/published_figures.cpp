#include "published_figures.h"

#include <array>

namespace chiaro::bench {
namespace {

constexpr std::string_view titan_nbuffers = "N-buffers on a GTX TITAN", titan_mipmaps = "mipmaps on a GTX TITAN",
                           gtx = "a pyramid on an 8800 GTX", opterons = "brute force on 8 Opterons 852",
                           ball = "a moving ball on 8 Opterons 852";

struct Entry {
    std::string_view row;
    Beside beside;
};

/// Kroes, Schut and Eisemann (512³, levels 0 to 6), Ritschel (256³, 400 directions), and local histograms (head of
/// 256 × 256 × 147, radius 16, 64 bins, 2048 words: histograms and codebook).
const std::array entries{
    Entry{"gpu/spao/nbuffer/levels", {{{268.9, titan_nbuffers}}, {}}},
    Entry{"gpu/spao/nbuffer/whole", {{{332.1, titan_nbuffers}}, {}}},
    Entry{"gpu/spao/mipmap/levels", {{{38.8, titan_mipmaps}}, {}}},
    Entry{"gpu/spao/mipmap/whole", {{{149.2, titan_mipmaps}}, {}}},
    Entry{"gpu/spao/fused/whole", {{{332.1, titan_nbuffers}, {149.2, titan_mipmaps}}, 3}},
    Entry{"gpu/visibility/128", {{{12.3e3, gtx}}, 20}},
    Entry{"gpu/visibility/256", {{{70.4e3, gtx}}, {}}},
    Entry{"gpu/transport/whole", {{}, 10}},
    Entry{"gpu/histogram/prepare", {{{60 * (101.6 + 61.6), opterons}, {60 * (10.26 + 61.6), ball}}, 0.5}},
    Entry{"gpu/frame/shells512-fog/none", {{}, 2}},
    Entry{"gpu/frame/shells512-opaque/none", {{}, 2}},
    Entry{"gpu/frame/shells512-sparse/none", {{}, 2}},
};

}  // namespace

Beside beside(std::string_view row) {
    for (const Entry& entry : entries)
        if (entry.row == row) return entry.beside;
    return {};
}

}  // namespace chiaro::bench
