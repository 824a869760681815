// SPDX-License-Identifier: MIT
// Every allocation fails once: what was being done ends in an exception, and nothing is left
// behind.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <new>

#include "octavo/io/check.h"
#include "octavo/io/mapped_file.h"
#include "octavo/io/validate.h"
#include "octavo/octavo.h"
#include "support/temporary_folder.h"

namespace {

std::atomic<long> allocations_left{-1};  // below 0: none fails
std::atomic<long> failed{0};
std::size_t least_bytes = 0;  // smaller ones do not fail

bool fails_now(std::size_t size) {
    if (size < least_bytes || allocations_left.load(std::memory_order_relaxed) < 0) return false;
    if (allocations_left.fetch_sub(1) != 0) return false;
    ++failed;
    return true;
}

void* allocate(std::size_t size, std::size_t alignment) {
    if (fails_now(size)) throw std::bad_alloc();
    void* memory =
        alignment <= alignof(std::max_align_t)
            ? std::malloc(size == 0 ? 1 : size)
            : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(std::size_t size) {
    return allocate(size, 1);
}
void* operator new[](std::size_t size) {
    return allocate(size, 1);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete[](void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace octavo {
namespace {

/// Runs the work with the first, the second, ... allocation failing, until none is left to fail.
/// After the first 200, steps grow by a tenth.
void fail_each_allocation(const char* name, const std::function<void()>& work,
                          const std::function<void()>& check = {}) {
    work();  // what is set up once and kept
    int runs = 0;
    for (long n = 0;; n += 1 + (n > 200 ? n / 10 : 0), ++runs) {
        failed = 0;
        allocations_left = n;
        bool ended = true;
        try {
            work();
        } catch (const std::bad_alloc&) {
            ended = false;
        } catch (const Error& error) {
            ended = false;
            allocations_left = -1;
            EXPECT_TRUE(error.code() == Errc::limit || error.code() == Errc::io)
                << name << ", allocation " << n << ": " << error.what();
        } catch (const std::exception& error) {
            ended = false;
            allocations_left = -1;
            ADD_FAILURE() << name << ", allocation " << n << ": " << error.what();
        }
        allocations_left = -1;
        if (check) check();
        if (ended && failed == 0) break;
    }
    std::cout << name << ": " << runs << " allocations failed\n";
    EXPECT_GE(runs, 1);
}

/// For the glTF reader: its JSON library takes memory while it destroys a tree, where nothing can
/// be thrown. A list of 64 values takes this much. (On Linux an allocation of some bytes does not
/// fail before the process is killed.)
constexpr std::size_t kBeyondJson = 1024;

class FailingAllocation : public testing::Test {
protected:
    ~FailingAllocation() override { least_bytes = 0; }
};

/// With lanterns, whose triangles are long lists in the metadata.
const Scene& small_scene() {
    static const Scene kScene = make_sample("courtyard", 0.05);
    return kScene;
}

/// Without them: a list of 64 values is what the library of the glTF reader stumbles over.
Scene scene_without_lamps() {
    Scene scene = small_scene();
    for (Material& material : scene.materials) material.emission = vec3(0.0f);
    return scene;
}

Model small_model() {
    BuildOptions options;
    options.depth = 5;
    options.tile = 16;
    options.threads = 1;
    return make_model("a", small_scene(), options.rule, build(small_scene(), options));
}

TEST_F(FailingAllocation, InABuildIsAnException) {
    fail_each_allocation("build", [] { (void)small_model(); });
}

TEST_F(FailingAllocation, InAWriteLeavesTheOldFile) {
    const test::TemporaryFolder folder;
    const Model model = small_model();
    EXPECT_GT(encode_metadata(model.metadata).size(), 2000u);
    for (const bool compress : {false, true}) {
        write_octv(folder / "a.octv", model, {.compress = compress});
        const std::string whole = test::file_content(folder / "a.octv");
        fail_each_allocation(
            compress ? "write compressed" : "write",
            [&] { write_octv(folder / "a.octv", model, {.compress = compress}); },
            [&] {
                ASSERT_EQ(test::file_content(folder / "a.octv"), whole);
                ASSERT_EQ(folder.entries(), 1u) << "a temporary file was left behind";
            });
    }
}

TEST_F(FailingAllocation, InAReadIsAnException) {
    const test::TemporaryFolder folder;
    const Model model = small_model();
    write_octv(folder / "a.octv", model);
    const std::vector<std::uint64_t> begins(model.dag.level_begins().begin(),
                                            model.dag.level_begins().end());
    fail_each_allocation("check", [&] {
        const auto faults =
            find_faults(begins, model.dag.words(), {.level_nodes = {}, .voxels = {}},
                        {.strict = true, .max_faults = 100});
        if (!faults.empty()) ADD_FAILURE() << faults[0].reason;
    });
    fail_each_allocation("copy", [&] {
        FileCopy copy(folder / "a.octv");
        copy.fetch(0, copy.bytes().size());
    });
    fail_each_allocation("validate", [&] {
        // What cannot be allocated must not become a finding about the file.
        const Validation found = validate_octv(folder / "a.octv", {.strict = true});
        if (!found.valid()) ADD_FAILURE() << found.findings[0].code;
    });
}

TEST_F(FailingAllocation, InAPictureIsAnException) {
    const test::TemporaryFolder folder;
    const Model model = small_model();
    RenderOptions options;
    options.width = options.height = 8;
    options.threads = 1;
    options.samples = 1;
    options.ao_samples = 2;
    options.shadow_samples = 2;
    fail_each_allocation("render", [&] {
        write_image(folder / "a.png", render(model.dag, model.grid(), options), 0.0);
    });
}

TEST_F(FailingAllocation, InTheLookAndTheLightOfCellsIsAnException) {
    const test::TemporaryFolder folder;
    BuildOptions build_options;
    build_options.depth = 4;
    build_options.threads = 1;
    const BuildResult built = build(small_scene(), build_options);
    Model model = make_model("a", small_scene(), build_options.rule, built);
    const AttributeOptions look{.normal = true, .level = 3, .threads = 1};
    fail_each_allocation("attributes", [&] {
        model.attributes = build_attributes(small_scene(), model.dag, model.grid(), look);
    });
    LitScene scene;
    scene.objects.push_back(
        {.dag = model.dag, .grid = model.grid(), .attributes = model.attributes});
    scene.lights = {Light{}};
    scene.sky = Sky::constant(vec3(0.5f));
    fail_each_allocation("light", [&] {
        light_cells(
            scene,
            {.bounces = 1, .lamp_rays = 1, .around_rays = 1, .source_rays = 1, .threads = 1});
    });
    model.light = scene.objects[0].light;
    model.metadata.light = LightSummary{1, scene.lights, "color:0.5,0.5,0.5"};
    RenderOptions options;
    options.width = options.height = 4;
    options.threads = options.samples = options.ao_samples = options.shadow_samples = 1;
    for (const Lighting lighting : {Lighting::cached, Lighting::gathered, Lighting::reference})
        fail_each_allocation("lit picture", [&] { (void)render_lit(scene, lighting, options); });
    fail_each_allocation("write lit", [&] { write_octv(folder / "a.octv", model); });
    fail_each_allocation("read lit",
                         [&] { EXPECT_FALSE(read_octv(folder / "a.octv").light.empty()); });
}

TEST_F(FailingAllocation, InAMeshReaderIsAnException) {
    const test::TemporaryFolder folder;
    for (const char* name : {"a.glb", "a.obj", "a.ply"}) {
        least_bytes = std::string(name) == "a.glb" ? kBeyondJson : 0;
        save_scene(scene_without_lamps(), folder / name);
        fail_each_allocation(name, [&] { (void)load_scene(folder / name); });
    }
}

}  // namespace
}  // namespace octavo
