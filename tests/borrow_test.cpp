// Voxels that somebody else has: read, never changed, never handed back.
#include <chiaro/error.h>
#include <chiaro/samples.h>
#include <chiaro/session.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <numeric>
#include <vector>

#include "devices.h"

using namespace chiaro;
using chiaro::testing::tested_device;

namespace {

/// The sample's bytes in a vector, and a volume that borrows them.
struct Lent {
    std::shared_ptr<std::vector<std::byte>> bytes;
    Volume volume = make_sample("ball", 40);

    Lent() {
        const std::byte* first = volume.voxels.data();
        bytes = std::make_shared<std::vector<std::byte>>(first, first + volume.voxels.size());
        volume.voxels = VoxelBuffer::borrow(bytes->data(), bytes->size(), bytes);
    }
};

Scene small_scene() {
    Scene scene;
    scene.volume = "sample:ball:40";
    scene.width = 48, scene.height = 36;
    return scene;
}

}  // namespace

TEST(Borrowed, KeepsItsOwnerAsLongAsItLives) {
    Lent lent;
    EXPECT_EQ(lent.volume.voxels.data(), lent.bytes->data());
    EXPECT_TRUE(lent.volume.voxels.is_borrowed());
    EXPECT_EQ(lent.bytes.use_count(), 2);
    VoxelBuffer moved = std::move(lent.volume.voxels);
    EXPECT_EQ(moved.data(), lent.bytes->data());
    EXPECT_EQ(lent.bytes.use_count(), 2);
    moved = VoxelBuffer();
    EXPECT_EQ(lent.bytes.use_count(), 1);
}

TEST(Borrowed, NothingIsDiscarded) {
    std::vector<std::byte> bytes(1 << 20, std::byte(7));
    VoxelBuffer buffer = VoxelBuffer::borrow(bytes.data(), bytes.size(), nullptr);
    buffer.discard(0, bytes.size());
    buffer.discard_before(bytes.size());
    buffer.use_small_pages();
    EXPECT_EQ(std::count(bytes.begin(), bytes.end(), std::byte(7)), std::ptrdiff_t(bytes.size()));
}

TEST(Borrowed, AMemoryThatMayOnlyBeReadGivesThePicture) {
    Progress progress;
    const Volume owned = make_sample("ball", 40);
    void* pages = mmap(nullptr, owned.voxels.size(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(pages, MAP_FAILED);
    std::copy_n(owned.voxels.data(), owned.voxels.size(), static_cast<std::byte*>(pages));
    ASSERT_EQ(mprotect(pages, owned.voxels.size(), PROT_READ), 0);
    const std::shared_ptr<const void> owner(
        pages, [bytes = owned.voxels.size()](const void* p) { munmap(const_cast<void*>(p), bytes); });
    Lent lent;  // for the header
    lent.volume.voxels = VoxelBuffer::borrow(pages, owned.voxels.size(), owner);
    Session session(tested_device()), another(tested_device());
    session.show(std::move(lent.volume), progress);
    another.show(owned, progress);
    EXPECT_EQ(session.render(small_scene(), progress).pixels, another.render(small_scene(), progress).pixels);
}

TEST(Borrowed, ASessionLeavesTheVolumeAsItIs) {
    Progress progress;
    Lent lent;
    const std::vector<std::byte> before = *lent.bytes;
    const Volume& volume = lent.volume;
    Session session(tested_device());
    session.show(volume, progress);
    session.expect_one_look();
    const auto pixels = session.render(small_scene(), progress).pixels;
    EXPECT_EQ(*lent.bytes, before);
    EXPECT_EQ(volume.voxels.data(), lent.bytes->data());
    session.show(std::move(lent.volume), progress);  // given away, but not its bytes
    EXPECT_EQ(session.render(small_scene(), progress).pixels, pixels);
    EXPECT_EQ(*lent.bytes, before);
    EXPECT_EQ(lent.bytes.use_count(), 1) << "bricks hold what is needed";
}

TEST(Borrowed, TheSessionsOfOneVolumeAreAlike) {
    Progress progress;
    const Volume volume = make_sample("shells", 40);
    Session one(tested_device()), two(tested_device());
    Scene scene = small_scene();
    scene.volume = "sample:shells:40";
    one.show(volume, progress), two.show(volume, progress);
    EXPECT_EQ(one.render(scene, progress).pixels, two.render(scene, progress).pixels);
}

// Each stage looks at cancellation itself, so that none that began before need come to its end.
TEST(Cancelled, EveryStageThatShowsAVolumeEndsInOneSentence) {
    const Device device = tested_device();
    Progress progress, cancelled;
    cancelled.cancel();
    for (const char* name : {"ball", "fog"}) {  // counted one by one, and at levels
        Volume volume = make_sample(name, 40);
        const DeviceVolume voxels = upload(device, volume, progress);
        const TransferFunction tf = sample_transfer_function(name);
        const std::function<void()> stages[] = {
            [&] { measure(volume, cancelled); }, [&] { upload(device, volume, cancelled); },
            [&] { classify(device, voxels, tf, {}, cancelled); }, [&] { Session(device).show(volume, cancelled); }};
        for (const auto& stage : stages) {
            try {
                stage();
                ADD_FAILURE() << "it went on to the end";
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::interrupted);
            }
        }
    }
}
