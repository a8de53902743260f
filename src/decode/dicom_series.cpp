#include "decode/dicom_series.h"

#include "volume/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace chiaro::decode {
namespace {

bool close(const Vec3& a, const Vec3& b) { return length(a - b) < 1e-3; }

bool belong_together(const DicomSlice& a, const DicomSlice& b) {
    return a.series == b.series && a.columns == b.columns && a.rows == b.rows && a.type == b.type &&
           a.has_place == b.has_place && close(a.along_row, b.along_row) && close(a.along_column, b.along_column) &&
           std::abs(a.column_spacing - b.column_spacing) < 1e-4 && std::abs(a.row_spacing - b.row_spacing) < 1e-4;
}

Vec3 normal_of(const DicomSlice& slice) { return cross(slice.along_row, slice.along_column); }

/// Where the slices of each place begin, and where the last one's end.
std::vector<std::ptrdiff_t> places_of(const DicomSeries& series) {
    std::vector<std::ptrdiff_t> begins;
    for (std::size_t i = 0; i < series.size(); ++i)
        if (i == 0 || !close(series[i].position, series[i - 1].position)) begins.push_back(std::ptrdiff_t(i));
    begins.push_back(std::ptrdiff_t(series.size()));
    return begins;
}

using Clock = std::optional<double> DicomSlice::*;

/// Sorts the slices of each place, unless one states no time or two state the same.
bool sort_by(Clock clock, const std::vector<std::ptrdiff_t>& places, DicomSeries& series) {
    DicomSeries sorted = series;
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
        const auto first = sorted.begin() + places[i], last = sorted.begin() + places[i + 1];
        if (std::any_of(first, last, [&](auto& slice) { return !(slice.*clock).has_value(); })) return false;
        std::sort(first, last, [&](auto& a, auto& b) { return a.*clock < b.*clock; });
        const auto is_same = [&](auto& a, auto& b) { return a.*clock == b.*clock; };
        if (std::adjacent_find(first, last, is_same) != last) return false;
    }
    series = std::move(sorted);
    return true;
}

/// Several slices at one place are several moments: of the wanted one each place keeps its slice, or else its first.
void keep_one_moment(DicomSeries& series, const Output& output, Volume& volume) {
    const auto places = places_of(series);
    if (places.size() == series.size() + 1) return;
    auto counts = places;
    std::adjacent_difference(places.begin(), places.end(), counts.begin());
    const auto [least, most] = std::minmax_element(counts.begin() + 1, counts.end());
    const bool has_triggers = sort_by(&DicomSlice::trigger_ms, places, series);
    const Clock clock = has_triggers ? &DicomSlice::trigger_ms : &DicomSlice::temporal;
    std::string why;
    if (!has_triggers && !sort_by(clock, places, series))
        why = "no trigger time or temporal position tells when";
    else if (*least != *most)
        why = fmt::format("the places have {} to {} each, so which belong together is not told", *least, *most);
    std::ptrdiff_t moment = 0;
    if (!why.empty()) {
        volume.notes.push_back(
            fmt::format("{} slices lie at the place of another; {}: the first at each place is taken",
                        series.size() - (places.size() - 1), why));
    } else {
        moment = std::ptrdiff_t(output.choose_moment(std::uint64_t(*most), volume));
        for (std::ptrdiff_t i = 0; i < *most; ++i) volume.moments.times.push_back(*(series[std::size_t(i)].*clock));
        if (has_triggers) volume.moments.unit = "ms";
    }
    DicomSeries kept;
    for (std::size_t i = 0; i + 1 < places.size(); ++i) kept.push_back(series[std::size_t(places[i] + moment)]);
    series = std::move(kept);
}

/// Slots that leave room for whole slices that are missing between evenly spaced ones, or none where that is not what
/// the positions show: each distance a multiple of the usual one, and not more missing than there.
std::vector<int> slots_with_gaps(const DicomSeries& series) {
    std::vector<double> distances;
    for (std::size_t i = 1; i < series.size(); ++i)
        distances.push_back(length(series[i].position - series[i - 1].position));
    if (distances.size() < 2) return {};
    auto sorted = distances;
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
    const double usual = sorted[sorted.size() / 2];
    std::vector<int> slots{0};
    for (const double distance : distances) {
        const double steps = std::round(distance / usual);
        if (steps < 1 || steps > double(series.size()) || std::abs(distance - steps * usual) > 0.1 * usual) return {};
        slots.push_back(slots.back() + int(steps));
    }
    const std::size_t missing = std::size_t(slots.back()) + 1 - series.size();
    return missing > 0 && missing <= series.size() ? slots : std::vector<int>{};
}

void note_missing(const DicomSeries& series, Volume& volume) {
    std::string where;
    int missing = 0;
    for (std::size_t i = 1; i < series.size(); ++i) {
        const int first = series[i - 1].slot + 2, last = series[i].slot;  // numbered from 1
        if (last < first) continue;
        missing += last - first + 1;
        where += (where.empty() ? "" : ", ") +
                 (first == last ? fmt::format("{}", first) : fmt::format("{}-{}", first, last));
    }
    volume.notes.push_back(
        fmt::format("{} of {} slices are missing ({}); they are interpolated between their neighbours", missing,
                    series.back().slot + 1, where));
}

void note_uneven(const DicomSeries& series, const Vec3& step, Volume& volume) {
    double worst = 0, least = length(step), greatest = least;
    for (std::size_t i = 1; i < series.size(); ++i) {
        worst = std::max(worst, length(series[i].position - (series[0].position + double(i) * step)));
        const double distance = length(series[i].position - series[i - 1].position);
        least = std::min(least, distance);
        greatest = std::max(greatest, distance);
    }
    // Positions are often rounded to a tenth of a millimetre, so a part of a step is no news.
    if (worst <= 0.2 * length(step)) return;
    volume.notes.push_back(
        fmt::format("slices are unevenly spaced ({:.4g} to {:.4g} mm apart, as where some are missing); they are shown "
                    "as if all were {:.4g} mm apart",
                    least, greatest, length(step)));
}

/// The slice axis follows the positions exactly, so a tilted gantry gives a sheared, not a skewed volume.
void note_tilt(const Vec3& normal, const Vec3& step, Volume& volume) {
    const double cosine = std::clamp(dot(normal, step) / length(step), -1.0, 1.0);
    const double degrees = std::acos(cosine) * 180 / std::numbers::pi;
    if (degrees > 0.1)
        volume.notes.push_back(fmt::format(
            "slices are shifted against each other by {:.3g} degrees (a tilted gantry); the volume is sheared to match",
            degrees));
}

}  // namespace

std::vector<DicomSeries> group_series(std::vector<DicomSlice> slices) {
    std::vector<DicomSeries> all;
    for (auto& slice : slices) {
        const auto found =
            std::find_if(all.begin(), all.end(), [&](auto& series) { return belong_together(series[0], slice); });
        if (found == all.end())
            all.push_back({std::move(slice)});
        else
            found->push_back(std::move(slice));
    }
    std::stable_sort(all.begin(), all.end(), [](auto& a, auto& b) { return a.size() > b.size(); });
    return all;
}

void arrange(DicomSeries& series, const Output& output, Volume& volume) {
    const DicomSlice first = series.at(0);
    const Vec3 normal = normal_of(first);
    std::stable_sort(series.begin(), series.end(), [](auto& a, auto& b) { return a.instance < b.instance; });
    Vec3 step = first.thickness * normal;
    const auto number_slots = [&] {
        for (std::size_t i = 0; i < series.size(); ++i) series[i].slot = int(i);
    };
    number_slots();
    if (first.has_place) {
        // Keys of 1 µm keep the order of instances at one place, where the last digits differ.
        const auto key = [&](const DicomSlice& slice) { return std::round(1000 * dot(slice.position, normal)); };
        for (const auto& slice : series)
            if (!std::isfinite(key(slice))) refuse("has a slice whose position is not finite");
        std::stable_sort(series.begin(), series.end(), [&](auto& a, auto& b) { return key(a) < key(b); });
        keep_one_moment(series, output, volume);
        number_slots();
        const auto slots = slots_with_gaps(series);
        for (std::size_t i = 0; i < slots.size(); ++i) series[i].slot = slots[i];
        volume.geometry.world = World::lps;
        volume.geometry.origin_mm = series[0].position;
        if (series.size() > 1) {
            step = (1.0 / double(series.back().slot)) * (series.back().position - series[0].position);
            slots.empty() ? note_uneven(series, step, volume) : note_missing(series, volume);
            note_tilt(normal, step, volume);
        }
    } else {
        volume.notes.push_back("its slices state no position; they are taken in the order of their numbers");
    }
    set_steps(volume.geometry, {first.column_spacing * first.along_row, first.row_spacing * first.along_column, step});
}

}  // namespace chiaro::decode
