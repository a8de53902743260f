// Light that several ranks find together is one rank's, bit for bit; and so are the pictures that they blend.
#include <chiaro/camera.h>
#include <chiaro/error.h>
#include <chiaro/render.h>
#include <chiaro/samples.h>
#include <chiaro/text.h>
#include <gtest/gtest.h>

#include "rank_frames.h"
#include "volume/device_volume.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

struct Partition {
    const char* name;
    std::vector<Cut> cuts;
};
/// Of 61 × 70 × 66 voxels.
const std::vector<Partition> partitions{
    {"one rank", {}},
    {"two halves", {{0, 2, 33}}},
    {"three ragged", {{0, 0, 17}, {1, 1, 49}}},
    {"eight", {{0, 2, 33}, {0, 1, 35}, {1, 1, 35}, {0, 0, 30}, {1, 0, 30}, {2, 0, 30}, {3, 0, 30}}},
    {"eight ragged", {{0, 2, 20}, {0, 1, 51}, {1, 0, 13}, {1, 1, 22}, {3, 0, 44}, {4, 2, 41}, {2, 0, 27}}}};

/// Some of a sample, so that blocks end anywhere; `thick`: slices of other cells than voxels.
Volume subject(bool thick) {
    Progress progress;
    const Volume all = make_sample("tubes", 72, progress);
    Volume some = block_of(all, {{3, 1, 2}, {64, 71, 68}}, 0);
    some.placement.reset();
    if (thick) some.geometry.spacing_mm.z *= 1.7;
    return some;
}

TransferFunction look() {
    TransferFunction tf;
    tf.points = {
        {20, {0.9, 0.5, 0.2}, 0}, {60, {0.9, 0.6, 0.3}, 0.02}, {110, {0.7, 0.6, 0.6}, 0.3}, {255, {0.3, 0.7, 1}, 0.9}};
    return tf;
}

struct Shown {
    IlluminationField field;
    Frame frame{160, 120};
};

Camera eye_of(const Volume& whole) {
    CameraSettings settings;
    settings.azimuth_deg = 28, settings.elevation_deg = 19, settings.zoom = 0.9;
    return make_camera(settings, whole.geometry, whole.dimensions);
}

Shown show(const Device& device, const Volume& volume, const Camera& camera, const IlluminationSettings& settings) {
    Progress progress;
    const Medium medium = classify(upload(device, volume), look(), {});
    Lighting lighting;
    Shown shown;
    illuminate(
        device, medium, Prepared(), lighting, settings,
        [&](IlluminationField finer) { shown.field = std::move(finer); }, progress);
    raycast(device, medium, shown.field, lighting, camera, {.early_termination = 0}, shown.frame, progress);
    return shown;
}

/// Of the cells among a block's own voxels, and of one more on each side, which samples look up.
std::size_t different_cells(const IlluminationField& one, const IlluminationField& block, const OwnVoxels& own) {
    const CellValues &all = *one.data().access, &some = *block.data().access;
    const CellGrid& grid = all.grid;
    std::size_t different = 0;
    for (int z = 0; z < grid.count[2]; ++z)
        for (int y = 0; y < grid.count[1]; ++y)
            for (int x = 0; x < grid.count[0]; ++x) {
                const Vec3 p = grid.voxel_of(x, y, z);
                bool near = true;
                for (int a = 0; a < 3; ++a)
                    near = near && p[a] > own.first[std::size_t(a)] - 1 && p[a] < own.end[std::size_t(a)];
                const std::size_t at = grid.index(x, y, z);
                different += near && all.data()[at] != some.data()[at];
            }
    return different;
}

IlluminationSettings by(Method method) {
    IlluminationSettings settings;
    settings.method = method;
    settings.transport.grid = 24, settings.transport.error = 0.05;
    settings.visibility.directions = 64;
    return settings;
}

void check(Method method, bool thick, const Partition& partition) {
    SCOPED_TRACE(std::string(to_text(method)) + (thick ? ", thick slices, " : ", ") + partition.name);
    const Volume whole = subject(thick);
    const Camera camera = eye_of(whole);
    const Device device = Device::cpu(1);
    const Shown one = show(device, whole, camera, by(method));
    const std::vector<OwnVoxels> blocks = cut_up(whole.dimensions, partition.cuts);
    std::vector<Frame> frames(blocks.size(), Frame(160, 120));
    on_ranks(int(blocks.size()), [&](std::shared_ptr<ThreadExchange> ranks) {
        const auto r = std::size_t(ranks->rank());
        Device shared = device;
        shared.ranks = ranks;
        const Shown part = show(shared, block_of(whole, blocks[r], ghosts_of(method)), camera, by(method));
        EXPECT_EQ(found(one.field), found(part.field)) << "rank " << r;
        if (method == Method::spao) {
            EXPECT_EQ(different_cells(one.field, part.field, blocks[r]), 0u) << "rank " << r;
        }
        frames[r] = part.frame;
    });
    std::vector<Placement> places;
    for (const OwnVoxels& own : blocks) places.push_back({whole.dimensions, {}, own.first, own.end});
    check_same(blended(frames, front_to_back(places, whole.geometry, camera)), one.frame);
}

TEST(Ranks, FindOneLightBySpao) {
    for (const Partition& partition : partitions) check(Method::spao, false, partition);
}
TEST(Ranks, FindOneLightByVisibility) {
    for (const Partition& partition : partitions) check(Method::visibility, false, partition);
}
TEST(Ranks, FindOneLightByTransport) {
    for (const Partition& partition : partitions) check(Method::transport, false, partition);
}
TEST(Ranks, FindOneLightWhereCellsAreNoVoxels) {
    for (const Method method : {Method::spao, Method::visibility, Method::transport})
        check(method, true, partitions.back());
}

/// No ray meets a block after one that it comes to later.
void check_order(const std::vector<int>& order, const std::vector<Placement>& places, Vec3 eye) {
    ASSERT_EQ(order.size(), places.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        for (std::size_t j = i + 1; j < order.size(); ++j) {
            const Placement &before = places[std::size_t(order[i])], &behind = places[std::size_t(order[j])];
            bool may_hide = true;  // what lies behind may hide what lies before
            for (std::size_t a = 0; a < 3; ++a) {
                if (behind.own_end[a] <= before.own_first[a]) may_hide = may_hide && eye[int(a)] < behind.own_end[a];
                if (before.own_end[a] <= behind.own_first[a]) may_hide = may_hide && eye[int(a)] > behind.own_first[a];
            }
            EXPECT_FALSE(may_hide) << order[j] << " before " << order[i];
        }
}

// Largest, smallest and mean values and sums along whole rays are joined by the ranks; every one of them has the
// picture.
TEST(Ranks, JoinValuesOfWholeRays) {
    const Volume whole = subject(false);
    const Camera camera = eye_of(whole);
    const auto cast = [&](const Device& device, const Volume& volume, Mode mode, RaySettings rays, Progress& progress) {
        Frame frame(160, 120);
        rays.early_termination = 0;
        const Medium medium = classify(upload(device, volume), look(), {.mode = mode});
        const RenderStatistics told = raycast(device, medium, {}, {}, camera, rays, frame, progress);
        return std::pair(frame, told.complete);
    };
    for (const Mode mode : {Mode::mip, Mode::minip, Mode::mean, Mode::additive})
        for (const Partition& partition : partitions) {
            SCOPED_TRACE(std::string(to_text(mode)) + ", " + partition.name);
            Progress progress;
            const Frame one = cast(Device::cpu(1), whole, mode, {}, progress).first;
            const std::vector<OwnVoxels> blocks = cut_up(whole.dimensions, partition.cuts);
            on_ranks(int(blocks.size()), [&](std::shared_ptr<ThreadExchange> ranks) {
                Device device = Device::cpu(1);
                device.ranks = ranks;
                Progress mine;
                check_same(cast(device, block_of(whole, blocks[std::size_t(ranks->rank())], 2), mode, {}, mine).first,
                           one);
            });
        }
    on_ranks(2, [&](std::shared_ptr<ThreadExchange> ranks) {
        Device device = Device::cpu(1);
        device.ranks = ranks;
        const Volume half = block_of(whole, cut_up(whole.dimensions, {{0, 2, 33}})[std::size_t(ranks->rank())], 2);
        Progress progress;
        EXPECT_THROW(cast(device, half, Mode::mip, {.samples_per_pixel = 4}, progress), Error);
    });
}

// Frames are blended in the order of the cuts, seen from anywhere, along parallel rays too.
TEST(Ranks, AreOrderedFromFrontToBack) {
    const Volume whole = subject(true);
    for (const Partition& partition : partitions) {
        std::vector<Placement> places;
        for (const OwnVoxels& own : cut_up(whole.dimensions, partition.cuts))
            places.push_back({whole.dimensions, {}, own.first, own.end});
        for (const double azimuth : {10.0, 100.0, 190.0, 280.0})
            for (const double zoom : {0.5, 1.0, 8.0}) {  // from among the blocks, too
                CameraSettings settings;
                settings.azimuth_deg = azimuth, settings.elevation_deg = azimuth / 4 - 30, settings.zoom = zoom;
                const Camera camera = make_camera(settings, whole.geometry, whole.dimensions);
                const Vec3 eye = whole.geometry.voxel_from_world(camera.eye);
                check_order(front_to_back(places, whole.geometry, camera), places, eye);
                Camera parallel = camera;
                parallel.projection = Projection::orthographic;
                const Vec3 ahead = whole.geometry.voxel_from_world_vector(camera.forward);
                check_order(front_to_back(places, whole.geometry, parallel), places, eye - 1e9 * ahead);
            }
    }
    // Each of these four lies half before the next one, round in a circle; and one that owns nothing.
    const std::array<int, 3> n{3, 3, 1};
    const std::vector<Placement> circle{{n, {}, {0, 0, 0}, {2, 1, 1}},
                                        {n, {}, {2, 0, 0}, {3, 2, 1}},
                                        {n, {}, {1, 2, 0}, {3, 3, 1}},
                                        {n, {}, {0, 1, 0}, {1, 3, 1}},
                                        {n, {}, {0, 0, 0}, {0, 0, 0}}};
    const Camera camera = eye_of(whole);
    EXPECT_THROW(front_to_back(circle, whole.geometry, camera), Error);
    EXPECT_EQ(front_to_back(std::span(circle).last(1), whole.geometry, camera), std::vector<int>{0});
}

/// Work of two ranks that show halves of a volume, or what `block` makes of them.
std::vector<std::string> errors_of(const std::function<Volume(int rank)>& block, const IlluminationSettings& settings,
                                   const Shape& shape = {}, const Lighting& lighting = {}) {
    std::vector<std::string> errors(2);
    on_ranks(2, [&](std::shared_ptr<ThreadExchange> ranks) {
        Device device = Device::cpu(1);
        device.ranks = ranks;
        Progress progress;
        try {
            const Medium medium = classify(upload(device, block(ranks->rank())), look(), shape);
            illuminate(
                device, medium, Prepared(), lighting, settings, [](const IlluminationField&) {}, progress);
        } catch (const Error& error) {
            errors[std::size_t(ranks->rank())] = error.what();
        }
    });
    return errors;
}
Volume half_of(const Volume& whole, int rank, int of_ghosts = ghosts_of(Method::spao)) {
    return block_of(whole, cut_up(whole.dimensions, {{0, 2, 33}})[std::size_t(rank)], of_ghosts);
}

// What is wrong on one rank is told by all, and none waits for it.
TEST(Ranks, FailTogether) {
    const Volume whole = subject(false);
    const auto no_finite_voxel = [&](int rank) {
        Volume block = half_of(whole, rank);
        block.components = rank == 1 ? 2 : 1;
        return block;
    };
    std::vector<std::string> errors = errors_of(no_finite_voxel, by(Method::spao));
    EXPECT_NE(errors[0].find("rank 1: "), std::string::npos) << errors[0];
    EXPECT_NE(errors[1].find("2 values a voxel"), std::string::npos) << errors[1];
    const auto few_ghosts = [&](int rank) { return half_of(whole, rank, rank == 0 ? 3 : ghosts_of(Method::spao)); };
    for (const Method method : {Method::spao, Method::visibility, Method::transport}) {
        errors = errors_of(few_ghosts, by(method));
        EXPECT_NE(errors[0].find("there are 3"), std::string::npos) << errors[0];
        EXPECT_NE(errors[1].find("rank 0: "), std::string::npos) << errors[1];
    }
    const auto other_slope = [&](int rank) {
        Volume block = half_of(whole, rank);
        block.slope = 1 + rank;
        return block;
    };
    for (const std::string& error : errors_of(other_slope, by(Method::none)))
        EXPECT_NE(error.find("not of one volume"), std::string::npos) << error;
    const auto nothing = [&](int) {
        Volume block;
        block.placement = Placement{whole.dimensions, {}, {}, {}};
        return block;
    };
    for (const std::string& error : errors_of(nothing, by(Method::none)))
        EXPECT_NE(error.find("no rank has voxels"), std::string::npos) << error;
}

TEST(Ranks, RefuseWhatNeedsAllVoxels) {
    const Volume whole = subject(false);
    const auto half = [&](int rank) { return half_of(whole, rank); };
    const auto is_told = [&](const IlluminationSettings& settings, const Shape& shape, const std::string& what) {
        for (const std::string& error : errors_of(half, settings, shape))
            EXPECT_NE(error.find(what), std::string::npos) << error;
    };
    is_told(by(Method::histogram), {}, "histogram needs all voxels");
    is_told({.method = Method::spao, .spao = {.filter = SpaoFilter::exact}}, {}, "automatic");
    is_told(by(Method::none), {.clip = {.largest = true}}, "largest piece");
    is_told(by(Method::none), {.interpolation = Interpolation::cubic}, "splines");
    is_told(by(Method::none), {.mode = Mode::iso, .iso = {{.value = 100}}}, "isosurfaces");
    Lighting over_floor, before_probe;
    over_floor.floor.show = before_probe.probe.background = true;
    for (const Lighting& lighting : {over_floor, before_probe})
        for (const Method method : {Method::none, Method::spao, Method::transport})
            for (const std::string& error : errors_of(half, by(method), {}, lighting))
                EXPECT_NE(error.find("without floor and background"), std::string::npos) << error;
    for (const std::string& error : errors_of([&](int) { return subject(false); }, by(Method::none)))
        EXPECT_NE(error.find("needs a placement"), std::string::npos) << error;
}

/// The range of values is all ranks', and so are what they are stored as and what stands for those that are none.
TEST(Ranks, StoreOneVolume) {
    const Volume bytes = subject(false);
    const auto as = [&](auto number, VoxelType type) {
        Volume whole = make_volume(bytes.dimensions, type);
        whole.slope = 0.5;
        const auto to = whole.as<decltype(number)>();
        for (std::size_t i = 0; i < to.size(); ++i)
            to[i] = decltype(number)(bytes.as<std::uint8_t>()[i] * 300.0 + double(i) / 1000);
        return whole;
    };
    const auto check_stored = [&](const Volume& whole) {
        const DeviceVolume one = upload(Device::cpu(1), whole);
        on_ranks(3, [&](std::shared_ptr<ThreadExchange> ranks) {
            Device device = Device::cpu(1);
            device.ranks = ranks;
            Volume block;  // the last rank has none
            block.placement = Placement{};
            const std::vector<OwnVoxels> halves = cut_up(whole.dimensions, {{0, 2, 33}});
            if (ranks->rank() < 2) block = block_of(whole, halves[std::size_t(ranks->rank())], 2);
            const DeviceVolume part = upload(device, block);
            EXPECT_EQ(part.data().stored, one.data().stored);
            EXPECT_EQ(part.data().stored_min, one.data().stored_min);
            EXPECT_EQ(part.data().stored_max, one.data().stored_max);
            EXPECT_EQ(part.data().scale, one.data().scale);
            EXPECT_EQ(part.data().offset, one.data().offset);
            EXPECT_EQ(part.dimensions(), whole.dimensions);
        });
    };
    check_stored(bytes);
    check_stored(as(std::int32_t(), VoxelType::i32));
    Volume floats = as(float(), VoxelType::f32);
    floats.as<float>()[7] = std::numeric_limits<float>::quiet_NaN();
    floats.as<float>().back() = std::numeric_limits<float>::infinity();
    check_stored(floats);
}

/// A rank that owns nothing takes part, and shows nothing.
TEST(Ranks, WithoutVoxelsFindTheSameLight) {
    const Volume whole = subject(false);
    const Camera camera = eye_of(whole);
    const Shown one = show(Device::cpu(1), whole, camera, by(Method::visibility));
    on_ranks(2, [&](std::shared_ptr<ThreadExchange> ranks) {
        Device device = Device::cpu(1);
        device.ranks = ranks;
        Volume block;
        block.placement = Placement{};
        if (ranks->rank() == 0) block = block_of(whole, {{0, 0, 0}, whole.dimensions}, 0);
        const Shown part = show(device, block, camera, by(Method::visibility));
        EXPECT_EQ(found(one.field), found(part.field));
        if (ranks->rank() == 1) {
            for (const float value : part.frame.rgba) ASSERT_EQ(value, 0);
        }
    });
}

}  // namespace
