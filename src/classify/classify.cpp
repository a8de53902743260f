#include <chiaro/error.h>

#include <algorithm>
#include <cmath>

#include "classify/gpu.h"
#include "classify/gradient_factor.h"
#include "classify/largest.h"
#include "classify/medium.h"
#include "classify/mixture.h"
#include "volume/placed.h"
#include "volume/splined.h"

namespace chiaro {

void validate(const Shape& shape) {
    const auto refuse = [](const std::string& sentence) { throw Error(ErrorCode::usage, sentence); };
    if (shape.mode == Mode::iso && shape.iso.empty())
        refuse("an isosurface picture needs at least one value: give --iso VALUE");
    if (int(shape.iso.size()) > max_isosurfaces) refuse("at most 8 isosurfaces can be shown at a time");
    if (int(shape.clip.planes.size()) > max_clip_planes) refuse("at most 6 clip planes can be used at a time");
    for (const ClipPlane& plane : shape.clip.planes)
        if (!(length(plane.normal) > 0)) refuse("a clip plane needs a normal other than 0,0,0");
    if (const auto& box = shape.clip.box)
        for (int axis = 0; axis < 3; ++axis)
            if (!((*box)[2 * axis] < (*box)[2 * axis + 1]))
                refuse("the clip box leaves nothing: each of x0,x1,y0,y1,z0,z1 must rise from the first to the second");
}

namespace {

/// Those that are there, and that opacity by gradient leaves something of; empty: all.
std::vector<std::uint8_t> cells_left(const DeviceVolume::Data& volume) {
    std::vector<std::uint8_t> left = cells_held(volume);
    if (!volume.factor) return left;
    const std::vector<std::uint8_t> steep = cells_with_factor(volume);
    if (left.empty()) return steep;
    for (std::size_t cell = 0; cell < left.size(); ++cell) left[cell] &= steep[cell];
    return left;
}

/// What needs voxels that other ranks hold.
void check_shared(const Shape& shape) {
    const auto refuse = [](const char* what) {
        throw Error(ErrorCode::usage, std::string("a volume that several ranks share has no ") + what);
    };
    if (shape.clip.largest) refuse("largest piece: pieces go on beyond a rank's block");
    if (shape.interpolation == Interpolation::cubic || shape.interpolation == Interpolation::smooth)
        refuse("splines: those of whole rows of voxels; choose linear interpolation");
    if (shape.mode == Mode::iso) refuse("isosurfaces yet: choose another mode");
}

/// On the GPU, which then holds it, or here.
void find_occupancy(const Device& device, Medium::Data& data, const Progress& progress) {
    progress.check();
    const DeviceVolume::Data& volume = data.volume.data();
    const RangeTest is_visible =
        data.shape.mode == Mode::iso ? crossed_range(volume, data.shape.iso) : visible_range(data.table);
    const auto on_gpu = [&] {
        cuda::Stream& stream = *device.stream;
        GpuOccupancy made = occupancy_on_gpu(stream, volume, is_visible);
        data.cells = std::move(made.codes);
        stream.device_cache()->keep(HostArray::of(data.weak_from_this(), data.cells), made.on_gpu.data(), stream);
    };
    if (volume.factor || volume.placement)
        data.cells = make_occupancy(volume.cells, std::cref(is_visible), device.threads, progress, cells_left(volume));
    else if (!cuda::try_gpu(device, on_gpu))
        data.cells = make_occupancy(volume.cells, std::cref(is_visible), device.threads, progress);
    data.find_occupied_fraction();
}

/// The volume by which values are found so.
DeviceVolume interpolated(const DeviceVolume& given, Interpolation interpolation, const Progress& progress) {
    const DeviceVolume volume = with_factor(given, nullptr);
    const DeviceVolume::Data* source = volume.data().source;
    const DeviceVolume voxels = source ? DeviceVolume(source->shared_from_this()) : volume;
    if (interpolation != Interpolation::cubic && interpolation != Interpolation::smooth) return voxels;
    return splined(voxels, interpolation == Interpolation::cubic, progress);
}

}  // namespace

Medium classify(const DeviceVolume& volume, const TransferFunction& tf, const Shape& shape) {
    return classify(volume.data().device, volume, tf, shape);
}

Medium classify(const Device& device, const DeviceVolume& volume, const TransferFunction& tf, const Shape& shape) {
    return classify(device, volume, tf, shape, Progress());
}

namespace {

/// By one value, whatever colours a factor may have.
Medium classified_value(const Device& device, const DeviceVolume& volume, const TransferFunction& tf,
                        const Shape& shape, const Progress& progress) {
    validate(tf);
    validate(shape);
    if (volume.data().placement) check_shared(shape);
    auto data = std::make_shared<Medium::Data>();
    data->volume = volume;
    data->shape = shape;
    data->table = make_optical_table(volume.data(), tf, shape);
    if (shape.clip.largest) data->volume = with_largest_piece(*data);
    data->volume = interpolated(data->volume, shape.interpolation, progress);
    if (shape.mode == Mode::dvr || shape.mode == Mode::additive)
        data->volume = with_factor(data->volume, make_factor(data->volume.data(), tf, shape.color));
    find_occupancy(device, *data, progress);
    return Medium(std::move(data));
}

/// Colours that change with the gradient are those of a mixture, of one channel.
Medium with_colors_by_gradient(const Device& device, const Medium& medium, const Progress& progress) {
    const auto& factor = medium.data().volume.data().factor;
    if (!factor || factor->colors.empty()) return medium;
    return mixed(device, {{medium.data().shared_from_this()}, nullptr}, medium.data().shape, progress);
}

bool shows_values_of_rays(const Shape& shape) { return !is_lit(shape.mode) && shape.mode != Mode::additive; }

}  // namespace

Medium classify(const Device& device, const DeviceVolume& volume, const TransferFunction& tf, const Shape& shape,
                const Progress& progress) {
    return with_colors_by_gradient(device, classified_value(device, volume, tf, shape, progress), progress);
}

namespace {

/// Throws Error{usage} for what is found of one value.
void check_one_value(const Shape& shape, const std::string& refusal) {
    const auto refuse = [&](const char* what) { throw Error(ErrorCode::usage, what + (" " + refusal)); };
    if (shape.mode == Mode::iso) refuse("--mode iso");
    if (shape.clip.largest) refuse("--largest");
}

/// Where a value of a whole ray is shown, gain is of its colour.
Medium classified_channel(const Device& device, const Channel& channel, Shape shape, const Progress& progress) {
    const bool of_rays = shows_values_of_rays(shape);
    if (!of_rays) shape.opacity_scale *= channel.gain;
    const Medium medium = classified_value(device, channel.volume, channel.transfer, shape, progress);
    if (!of_rays || channel.gain == 1) return medium;
    auto data = std::make_shared<Medium::Data>();
    const Medium::Data& from = medium.data();
    data->volume = from.volume, data->table = from.table, data->shape = from.shape;
    data->cells = from.cells, data->occupied_fraction = from.occupied_fraction;
    for (OpticalTable::Entry& e : data->table.entries)
        for (float* c : {&e.r, &e.g, &e.b}) *c *= float(channel.gain);
    return Medium(std::move(data));
}

void check_channels(const std::vector<Channel>& channels, const Shape& shape) {
    const auto refuse = [](const std::string& sentence) { throw Error(ErrorCode::usage, sentence); };
    if (channels.empty()) refuse("a medium needs at least one channel");
    std::size_t shown = 0;
    for (const Channel& channel : channels) {
        if (!(channel.gain >= 0) || !std::isfinite(channel.gain)) refuse("the gain of a channel must be 0 or more");
        shown += channel.gain > 0;
    }
    if (shown > 1) check_one_value(shape, "is of one channel: hide the others (gain 0)");
}

}  // namespace

Medium classify(const Device& device, const std::vector<Channel>& channels, const Shape& shape,
                const Progress& progress) {
    check_channels(channels, shape);
    std::vector<std::shared_ptr<const Medium::Data>> shown;
    for (const Channel& channel : channels)
        if (channel.gain > 0)
            shown.push_back(classified_channel(device, channel, shape, progress).data().shared_from_this());
    if (shown.empty()) {
        Shape nothing = shape;
        nothing.opacity_scale = 0;
        return classify(device, channels.front().volume, channels.front().transfer, nothing, progress);
    }
    if (shown.size() == 1) return with_colors_by_gradient(device, Medium(std::move(shown.front())), progress);
    return mixed(device, {std::move(shown), nullptr}, shape, progress);
}

Medium classify(const Device& device, const OwnColors& own, const Shape& shape, const Progress& progress) {
    check_one_value(shape, "is of values: a volume is shown in its own colours, and --channels-as channels has values");
    const bool of_rays = shows_values_of_rays(shape);
    if (of_rays && own.value)
        throw Error(ErrorCode::usage, "colours by another value have no meaning for a value of a whole ray");
    MixtureParts parts{{}, nullptr, !of_rays};
    const auto add = [&](const DeviceVolume& volume, const TransferFunction& tf) {
        parts.channels.push_back(classified_value(device, volume, tf, shape, progress).data().shared_from_this());
    };
    if (own.value) {
        TransferFunction colors = own.colors;
        for (ControlPoint& point : colors.points) point.opacity = 0;
        add(own.opacity, own.transfer), add(own.value, colors);
        return mixed(device, std::move(parts), shape, progress);
    }
    // Its colours are what is taken where there is matter that nothing was looked up of: luminance, about.
    TransferFunction opacity = own.transfer;
    opacity.rgb_space = RgbSpace::srgb;
    for (ControlPoint& point : opacity.points) point.rgb.fill(std::clamp(point.value / own.white, 0.0, 1.0));
    if (!of_rays) add(own.opacity, opacity);
    for (std::size_t c = 0; c < 3; ++c) {
        Rgb most{};
        most[c] = 1;
        TransferFunction tf{.points = {{0, {}, 0}, {own.white, most, 0}}};
        // Of whole rays colours add up where there are any.
        if (of_rays) {
            Rgb least{};
            least[c] = 1.0 / 255;
            tf.points = {{0, {}, 0}, {own.white / 255, least, 1}, {own.white, most, 1}};
        }
        add(own.rgb[c], tf);
    }
    return mixed(device, std::move(parts), shape, progress);
}

Medium with_interpolation(const Device& device, const Medium& medium, Interpolation interpolation,
                          const Progress& progress) {
    const Medium::Data& from = medium.data();
    if (is_mixed(from)) {
        MixtureParts parts = parts_of(from);
        for (auto& channel : parts.channels)
            channel = with_interpolation(device, Medium(channel), interpolation, progress).data().shared_from_this();
        Shape shape = from.shape;
        shape.interpolation = interpolation;
        return mixed(device, std::move(parts), shape, progress);
    }
    auto data = std::make_shared<Medium::Data>();
    data->volume = with_factor(interpolated(from.volume, interpolation, progress), from.volume.data().factor);
    data->table = from.table;
    data->shape = from.shape;
    data->shape.interpolation = interpolation;
    data->share = from.share, data->surface_labels = from.surface_labels;
    find_occupancy(device, *data, progress);
    return Medium(std::move(data));
}

double Medium::occupied_fraction() const { return data().occupied_fraction; }

}  // namespace chiaro
