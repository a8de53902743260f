// Slices put in order: which belong together, and where they lie.
#pragma once
#include "decode/dicom_scan.h"
#include "decode/output.h"

namespace chiaro::decode {

/// Slices that form one volume: the same series, size, type and orientation.
using DicomSeries = std::vector<DicomSlice>;

/// All series, the largest first.
std::vector<DicomSeries> group_series(std::vector<DicomSlice> slices);

/// Sorts the slices along their normal, keeps of those at one place the wanted moment's, gives each its slot, and sets
/// the geometry of `volume`. What is out of the ordinary (tilted, uneven, repeated or missing slices, no positions) is
/// put into its notes. Where whole slices are missing in an even series, their slots are left empty.
void arrange(DicomSeries& series, const Output& output, Volume& volume);

}  // namespace chiaro::decode
