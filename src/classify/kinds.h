// What of a medium counts as something.
#pragma once
#include <algorithm>
#include <cmath>

#include "classify/medium.h"

namespace chiaro {

/// What a stored value is: 0 shows nothing, 1 something, 2 is part of a piece.
struct Kinds {
    static constexpr double least_opacity = 0.1;  ///< of a part of a piece
    const Medium::Data& medium;
    std::vector<std::uint8_t> of_entry;  ///< of the optical table
    double lowest = 0;                   ///< of the surfaces, in data units

    explicit Kinds(const Medium::Data& of) : medium(of) {
        for (const OpticalTable::Entry& entry : medium.table.entries) {
            const double opacity = -std::expm1(-double(entry.extinction_per_mm) * medium.table.unit_mm);
            of_entry.push_back(opacity >= least_opacity ? 2 : opacity > 0 ? 1 : 0);
        }
        const auto lower = [](const IsoSurface& a, const IsoSurface& b) { return a.value < b.value; };
        if (is_iso()) lowest = std::min_element(medium.shape.iso.begin(), medium.shape.iso.end(), lower)->value;
    }
    bool is_iso() const { return medium.shape.mode == Mode::iso; }
    std::size_t entry(float stored) const { return medium.table.nearest(stored); }
    std::uint8_t of(float stored) const {
        if (!is_iso()) return of_entry[entry(stored)];
        const DeviceVolume::Data& volume = medium.volume.data();
        return volume.scale * stored + volume.offset >= lowest ? 2 : 0;
    }
};

}  // namespace chiaro
