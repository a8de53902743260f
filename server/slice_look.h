// What slices look like: grey, in the transfer function's colours, or channels added up; with labels over them.
#pragma once
#include <chiaro/image.h>
#include <chiaro/session.h>

#include <memory>
#include <vector>

#include "json.h"

namespace chiaro::server {

/// A channel's values: in memory, or read where they are asked for.
struct Values {
    DeviceVolume volume;
    std::shared_ptr<const BrickSource> source;  ///< of a volume by bricks, of which `volume` is a level; null: is whole

    /// As chiaro::slice.
    Slice slice(const SlicePlane& plane, SliceSampling sampling, bool finest, Progress& progress) const;
};

struct SliceLook {
    SliceTone tone;
    std::vector<SliceChannel> channels;  ///< several, in the place of the tone; without their values
    std::vector<DeviceVolume> volumes;   ///< of the channels
    std::shared_ptr<const LabelVolume> labels;
    std::vector<Label> looks;
    double opacity = 0;  ///< of labels

    Image drawn(const Values& values, const SlicePlane& plane, SliceSampling sampling, Progress& progress) const;
};

/// Of a request (PROTOCOL.md, `slice`) and its part of a scene. Channels are seen from where their transfer functions
/// begin to where they end, in the colour of their densest matter. Throws Error{usage} that names the field, and as
/// Session::labels.
SliceLook slice_look(const Json& request, const Scene& scene, const Session& session, Progress& progress);

}  // namespace chiaro::server
