// What goes wrong with GPUs, and whether the one on the emulated GPU is one.
#include <cstring>
#include <thread>

#include "bench.h"
#include "cuda_case.h"
#include "illumination/histogram/histograms.h"
#include "illumination/transport/matter.h"
#include "illumination/transport/solver.h"

using namespace chiaro;
using namespace chiaro::testing;

namespace {

std::string error_of(const std::function<void()>& act, ErrorCode code = ErrorCode::output) {
    try {
        act();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code);
        return error.what();
    }
    return "";
}

std::size_t downloaded() { return cuda_emulated::gpu().downloaded_bytes; }

/// As it was, once a test has made trouble.
class FailingGpus : public Gpus {
protected:
    void TearDown() override {
        const cuda_emulated::Gpu whole;
        cuda_emulated::Gpu& gpu = cuda_emulated::gpu();
        gpu.count = whole.count, gpu.memory_bytes = whole.memory_bytes;
        gpu.driver_version = whole.driver_version, gpu.next_wait = whole.next_wait;
        gpu.next_launch = whole.next_launch, gpu.host_memory = whole.host_memory;
    }
};

}  // namespace

TEST_F(FailingGpus, AreNamedInOneSentence) {
    const auto choose = [] { Device::cuda(0, Device::cpu()); };
    EXPECT_EQ(error_of([] { Device::cuda(3, Device::cpu()); }), "--device cuda:3: there is no such GPU (0 to 0)");
    cuda_emulated::gpu().driver_version = 12020;
    EXPECT_EQ(error_of(choose), "--device cuda: the NVIDIA driver is for CUDA 12.2, and this build needs 13.0");
    EXPECT_TRUE(list_gpus().empty());
    EXPECT_FALSE(choose_device(Device::cpu()).device.has_gpu());
    cuda_emulated::gpu().driver_version = 13000;
    cuda_emulated::gpu().count = 0;
    EXPECT_EQ(error_of(choose), "--device cuda: there is no NVIDIA GPU");
    cuda_emulated::gpu().driver_version = 0;
    EXPECT_EQ(error_of(choose), "--device cuda: there is no NVIDIA driver");
}

TEST_F(FailingGpus, AreChosenWhereTheyHaveMemory) {
    const DeviceChoice choice = choose_device(Device::cpu(2));
    EXPECT_EQ(choice.device.name(), "cuda:0");
    EXPECT_EQ(choice.sentence.find("on cuda:0 (Emulated), "), 0u) << choice.sentence;
    cuda_emulated::gpu().memory_bytes = std::size_t(700) << 20;
    const DeviceChoice small = choose_device(Device::cpu(2));
    EXPECT_EQ(small.device.name(), "cpu");
    EXPECT_EQ(small.sentence.find("cuda:0 (Emulated) has "), 0u) << small.sentence;
    EXPECT_NE(small.sentence.find("the CPU does the work"), std::string::npos) << small.sentence;
}

TEST_F(FailingGpus, WithoutRoomGiveWayOnlyWhereTheyWereChosenByThemselves) {
    const Volume volume = shells_of<std::uint8_t>(40);
    Shot shot = shaded();
    const Frame expected = shot(volume);
    const DeviceChoice choice = choose_device(Device::cpu(2));
    cuda_emulated::gpu().memory_bytes = cuda_emulated::gpu().held_bytes + 100000;
    shot.device = gpu;
    EXPECT_NE(error_of([&] { shot(volume); }).find("MiB more do not fit: 0 of"), std::string::npos);
    shot.device = choice.device;
    EXPECT_EQ(difference(shot(volume), expected, 0).pixels_beyond, 0);
    EXPECT_NE(shot.device.note().find("; the CPU does the work"), std::string::npos) << shot.device.note();
    EXPECT_EQ(choice.device.with_own_stream().note(), "");
}

TEST_F(FailingGpus, GiveWayWhereverMemoryEnds) {
    const Volume volume = shells_of<std::uint8_t>(36);
    for (const Method method : {Method::visibility, Method::spao}) {
        IlluminationSettings light{.method = method};
        light.visibility.directions = 50;
        Shot shot = shaded();
        shot.device = cpu();
        const Frame expected = shot.lit(volume, light);
        int gave_way = 0;
        for (const std::size_t more : {1 << 14, 1 << 16, 1 << 18, 1 << 19, 1 << 20, 3 << 19, 1 << 21, 1 << 23}) {
            cuda_emulated::gpu().memory_bytes = std::size_t(4) << 30;
            shot.device = choose_device(cpu()).device;
            cuda_emulated::gpu().memory_bytes = cuda_emulated::gpu().held_bytes + more;
            EXPECT_EQ(difference(shot.lit(volume, light), expected, 0).pixels_beyond, 0) << more;
            gave_way += !shot.device.note().empty();
            shot.device = {};
        }
        EXPECT_GT(gave_way, 2);
        EXPECT_LT(gave_way, 8);
    }
}

TEST_F(FailingGpus, GiveWayAtAnyStepOfPreparingHistograms) {
    const Volume volume = shells_of<std::uint8_t>(20);
    const auto prepared = [&](const Device& device) {
        StageTimer timer;
        Progress progress;
        const HistogramSettings settings{.radius = 4, .clusters = 20, .packed_bins = 16};
        return find_local_histograms(device, upload(device, volume).data(), settings, timer, progress);
    };
    const LocalHistograms expected = prepared(cpu());
    int gave_way = 0;
    for (const std::size_t more : {1 << 14, 1 << 17, 3 << 17, 1 << 20, 1 << 22, 1 << 23, 1 << 24, 1 << 26}) {
        cuda_emulated::gpu().memory_bytes = std::size_t(4) << 30;
        const Device device = choose_device(cpu()).device;
        cuda_emulated::gpu().memory_bytes = cuda_emulated::gpu().held_bytes + more;
        const LocalHistograms found = prepared(device);
        EXPECT_EQ(std::memcmp(found.displaced.data(), expected.displaced.data(), expected.displaced.size()), 0) << more;
        EXPECT_EQ(found.shares, expected.shares) << more;
        gave_way += !device.note().empty();
    }
    EXPECT_GT(gave_way, 3);
    EXPECT_LT(gave_way, 8);
}

TEST_F(FailingGpus, PrepareHistogramsPlaneByPlaneWhereTheyHaveLittleMemory) {
    const Volume volume = shells_of<std::uint8_t>(36);
    for (const HistogramPath path : {HistogramPath::fast, HistogramPath::exact, HistogramPath::sweep}) {
        const HistogramSettings settings{.radius = 3, .clusters = 20, .packed_bins = 16, .path = path};
        const auto prepared = [&](const Device& device) {
            StageTimer timer;
            Progress progress;
            return find_local_histograms(device, upload(device, volume).data(), settings, timer, progress);
        };
        const auto on_gpu_of = [&](std::size_t memory, std::size_t& launches) {
            cuda_emulated::gpu().memory_bytes = cuda_emulated::gpu().held_bytes + memory;
            const std::size_t before = cuda_emulated::gpu().launches;
            LocalHistograms found = prepared(Device::cuda(0, cpu()));
            launches = cuda_emulated::gpu().launches - before;
            cuda_emulated::gpu().memory_bytes = std::size_t(4) << 30;
            return found;
        };
        const LocalHistograms expected = prepared(cpu());
        std::size_t few = 0, many = 0;
        for (const auto& [memory, launches] : {std::pair(std::size_t(2) << 30, &few), {std::size_t(8) << 20, &many}}) {
            const LocalHistograms found = on_gpu_of(memory, *launches);
            EXPECT_EQ(std::memcmp(found.displaced.data(), expected.displaced.data(), expected.displaced.size()), 0);
            EXPECT_EQ(found.shares, expected.shares);
        }
        EXPECT_GT(many, few + 20);
    }
}

TEST_F(FailingGpus, GiveWayBeforeAnIterationAndWithinOne) {
    const Volume volume = shells_of<std::uint8_t>(24);
    const Medium medium = classify(upload(cpu(), volume), two_materials(), {});
    Progress progress;
    const auto solved = [&](const Device& device, std::size_t room, std::size_t room_later) {
        const auto set = [](std::size_t more) {
            cuda_emulated::gpu().memory_bytes = cuda_emulated::gpu().held_bytes + more;
        };
        set(room);
        TransportSolver solver(device, medium.data(), {}, {.grid = 30}, {}, {0, 0, 1}, progress);
        solver.iterate(progress);
        set(room_later);
        for (int i = 0; i < 2; ++i) solver.iterate(progress);
        set(std::size_t(1) << 30);
        return solver.nodes();
    };
    const std::size_t all = std::size_t(1) << 30;
    const TransportNodes expected = solved(cpu(), all, all);
    int gave_way = 0;
    for (const auto& [room, later] : {std::pair(all, all),
                                      {all, std::size_t(1000)},
                                      {std::size_t(1) << 20, all},
                                      {std::size_t(5) << 20, all},
                                      {std::size_t(1000), all}}) {
        cuda_emulated::gpu().memory_bytes = std::size_t(4) << 30;
        const Device device = choose_device(cpu()).device;
        const TransportNodes found = solved(device, room, later);
        EXPECT_EQ(found.light, expected.light) << room << ", " << later;
        EXPECT_EQ(found.moment, expected.moment);
        EXPECT_EQ(found.change, expected.change);
        gave_way += !device.note().empty();
    }
    EXPECT_EQ(gave_way, 4);
}

TEST_F(FailingGpus, GiveWayBeforeOtherLightToStartFrom) {
    const Volume volume = shells_of<std::uint8_t>(56);
    const Medium medium = classify(upload(cpu(), volume), walls(), {});
    Progress progress;
    TransportSolver finer(cpu(), medium.data(), {}, {.grid = 60}, {}, {0, 0, 1}, progress);
    finer.iterate(progress);
    const TransportNodes warm = finer.nodes();
    const auto started = [&](const Device& device, std::size_t room) {
        cuda_emulated::gpu().memory_bytes = cuda_emulated::gpu().held_bytes + room;
        const SharedTransportMedium matter = matter_of(cpu(), medium.data(), 10, {}, progress);
        TransportSolver solver(device, matter, {}, {.grid = 10}, {}, {0, 0, 1}, progress, &warm);
        cuda_emulated::gpu().memory_bytes = std::size_t(4) << 30;
        solver.iterate(progress);
        return solver.nodes();
    };
    const std::size_t all = std::size_t(1) << 30;
    const TransportNodes expected = started(cpu(), all);
    for (const std::size_t room : {all, std::size_t(3) << 19}) {
        const Device device = choose_device(cpu()).device;
        const TransportNodes found = started(device, room);
        EXPECT_EQ(found.light, expected.light) << room;
        EXPECT_EQ(found.moment, expected.moment) << room;
        EXPECT_EQ(device.note().empty(), room == all);
    }
}

TEST_F(FailingGpus, GiveWayWithFramesAndPathsHalfDone) {
    const Volume volume = shells_of<std::uint8_t>(32);
    const Medium medium = classify(upload(cpu(), volume), two_materials(), {});
    const Lighting lighting{.probe = {.source = "sky", .background = true}, .loaded_probe = load_probe("sky")};
    const Camera camera = make_camera({}, volume.geometry, volume.dimensions);
    Progress progress;
    const auto seen_by = [&](const Device& device, auto&& then) {
        DeviceFrame frame(45, 37);
        raycast(device, medium, {}, lighting, camera, {}, frame, progress);
        then();
        return develop(frame, {}).pixels;
    };
    const auto traced_by = [&](const Device& device, auto&& then) {
        IlluminationSettings light{.method = Method::reference};
        light.reference.rays = 4;  // in passes of 1, 1, 2
        Frame frame(45, 37);
        trace_paths(device, medium, lighting, camera, {}, light, frame, progress,
                    [&](const Frame&, const PathStatistics& paths) {
                        if (paths.samples == 2) then();
                    });
        return frame.rgba;
    };
    const auto without_room = [&](auto&& image) {
        const auto no_launch = [] { cuda_emulated::gpu().next_launch = cudaErrorMemoryAllocation; };
        const auto no_memory = [] { cuda_emulated::gpu().memory_bytes = cuda_emulated::gpu().held_bytes; };
        for (const std::function<void()>& then : {std::function<void()>(no_launch), {no_memory}}) {
            const Device device = choose_device(cpu()).device;
            const auto found = image(device, then);
            cuda_emulated::gpu().memory_bytes = std::size_t(4) << 30;
            EXPECT_NE(device.note(), "");
            EXPECT_EQ(found, image(cpu(), [] {}));
        }
    };
    without_room(seen_by);
    without_room(traced_by);
    cuda_emulated::gpu().host_memory = cudaErrorMemoryAllocation;  // then pictures come straight
    const Device device = Device::cuda(0, cpu());
    EXPECT_EQ(seen_by(device, [] {}), seen_by(cpu(), [] {}));
}

TEST_F(Gpus, BringWhatTheyFoundToAHostThatReadsIt) {
    const Volume volume = shells_of<std::uint8_t>(40);
    const IlluminationSettings light{.method = Method::spao};
    const Medium medium = classify(upload(gpu, volume), two_materials(), {});
    Progress progress;
    IlluminationField field;
    const auto keep = [&](IlluminationField found) { field = std::move(found); };
    const auto drawn = [&](const Device& device) {
        Shot shot = shaded();
        Frame frame(shot.width, shot.height);
        raycast(device, medium, field, shot.lighting, make_camera({}, volume.geometry, volume.dimensions), shot.rays,
                frame, progress);
        return frame;
    };
    const std::size_t answer = volume.voxel_count() * sizeof(std::uint16_t), before = downloaded();
    illuminate(gpu, medium, Prepared(), {}, light, keep, progress);
    const Frame there = drawn(gpu);
    EXPECT_LT(downloaded() - before, answer);
    const std::size_t unread = downloaded();
    EXPECT_EQ(difference(drawn(cpu()), there, 0).pixels_beyond, 0);
    EXPECT_GE(downloaded() - unread, answer);
    EXPECT_LT(downloaded() - unread, 2 * answer) << "both answers";
    const std::size_t read = downloaded();
    drawn(cpu());
    EXPECT_EQ(downloaded(), read);
}

TEST_F(FailingGpus, ThatAreLostAreTold) {
    Shot shot = shaded();
    shot.device = gpu;
    const Volume volume = shells_of<std::uint8_t>(40);
    cuda_emulated::gpu().next_wait = cudaErrorIllegalAddress;
    EXPECT_EQ(error_of([&] { shot(volume); }),
              "cuda:0 (Emulated) was lost: an illegal memory access was encountered; start again, or use --device cpu");
}

TEST_F(FailingGpus, HoldNothingInTheEnd) {
    const auto before = cuda_emulated::gpu().held_bytes;
    {
        Shot shot = shaded();
        shot.device = Device::cuda(0, cpu());
        shot(shells_of<std::uint8_t>(40));
        EXPECT_GT(cuda_emulated::gpu().held_bytes, before);
    }
    EXPECT_EQ(cuda_emulated::gpu().held_bytes, before);
}

TEST_F(Gpus, AreTimedByTheBench) {
    Progress progress;
    const bench::Setup setup{.device = gpu, .quick = true, .runs = 2, .progress = progress};
    std::vector<bench::Row> rows;
    bench::run(
        setup,
        {{"gpu"}, "copy|upload|download|words|transport|gpu/(spao|visib|histogram)|shells256-opaque.(none|classify)"},
        [&](const bench::Row& row) { rows.push_back(row); });
    ASSERT_EQ(rows.size(), 21u);
    for (const bench::Row& row : rows) {
        EXPECT_EQ(row.value.runs, 2) << row.name << row.note;
        EXPECT_GT(row.value.min, 0) << row.name;
        EXPECT_EQ(row.ratio.has_value(), row.name != "gpu/copy") << row.name;
    }
}

TEST(RowsOfGpus, StandBesideWhatThePapersMeasured) {
    Progress progress;
    const bench::Setup setup{.device = Device::cpu(1), .progress = progress};
    int rows = 0;
    for (const bench::Case& each : bench::gpu_cases(setup))
        for (const std::string& name : each.names)
            rows += !bench::beside(name).papers.empty() || bench::beside(name).target;
    EXPECT_EQ(rows, 12);  // all there are
    bench::Row row{"gpu/spao/fused/whole", "ms", {5, 4, 6, 3}};
    row.beside = bench::beside(row.name);
    EXPECT_NE(bench::line_of(row).find("; paper 332.1, N-buffers on a GTX TITAN; paper 149.2, "), std::string::npos);
    EXPECT_NE(bench::line_of(row).find("; target 3"), std::string::npos);
    const std::string json = bench::to_json(setup, {row});
    for (const char* told : {"\"value\": 332.1", "\"of\": \"mipmaps on a GTX TITAN\"", "\"target\": 3.0"})
        EXPECT_NE(json.find(told), std::string::npos) << told;
}

// The emulated GPU must be one: what the tests rely on.
TEST(EmulatedGpuDeathTest, KeepsTheHostOut) {
    const Device gpu = Device::cuda(0, Device::cpu(1));
    cuda::Array<int> numbers(*gpu.stream, 10);
    int host[10] = {};
    EXPECT_DEATH(std::memcpy(host, numbers.data(), 4), "");
    EXPECT_DEATH(gpu.stream->upload(numbers.data() + 5, host, sizeof host), "leaves the GPU's memory");
    const void* pointer = host;
    EXPECT_DEATH(cuda_emulated::refuse_host_pointers_in(pointer), "pointer of the host");
    numbers.zero();
    gpu.stream->download(host, numbers.data(), sizeof host);
    gpu.stream->wait();
    EXPECT_EQ(host[9], 0);
}

TEST(EmulatedGpu, DoesNotLookAtPadding) {
    struct Element {
        float weight;
        double sum;
    };
    struct Kernel {
        Element elements[8];
        std::int32_t count;
        double* out;
    };
    const cuda_emulated::CountedBytes<Kernel> counted;
    EXPECT_EQ(std::count(std::begin(counted.at), std::end(counted.at), 0), 8 * 4 + 4);
}

TEST(EmulatedGpuDeathTest, DoesItsWorkWhenTheHostWaits) {
    const Device gpu = Device::cuda(0, Device::cpu(1));
    const cuda::Array<int> numbers(*gpu.stream, 1);
    int sent = 1, back = 0;
    gpu.stream->upload(numbers.data(), &sent, sizeof sent);
    gpu.stream->download(&back, numbers.data(), sizeof back);
    sent = 2;  // too early
    EXPECT_EQ(back, 0);
    gpu.stream->wait();
    EXPECT_EQ(back, 2);
}

TEST_F(FailingGpus, FetchForThreadsThatShareAStream) {
    const auto fetched = [&](int value) {
        const std::vector<int> sent(100000, value);
        const cuda::Array<int> there(*gpu.stream, sent.size());
        gpu.stream->upload(there.data(), sent.data(), sent.size() * sizeof(int));
        for (int turn = 0; turn < 50; ++turn) {
            std::vector<int> found(sent.size());
            gpu.stream->fetch(found.data(), there.data(), found.size() * sizeof(int));
            if (found != sent) return false;
        }
        return true;
    };
    bool is_right = false;
    std::thread other([&] { is_right = fetched(1); });
    EXPECT_TRUE(fetched(2));
    other.join();
    EXPECT_TRUE(is_right);
}
