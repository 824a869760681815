// SPDX-License-Identifier: MIT
//
// The shared text must compile in every language that it is meant for.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>

namespace octavo {
namespace {

const std::string kSource = OCTAVO_SOURCE_DIR "/src/octavo/";
const std::string kUseAll = R"(
    GridRay ray;
    ray.cell = ivec3(1, 2, 3); ray.frac = vec3(0.5f); ray.dir = vec3(1.0f); ray.t_min = 0.0f; ray.t_max = 9.0f;
    Stop stop; stop.height = 0; stop.cone = 0.0f; stop.time_before = 0.0f;
    Bundle beam;
    beam.cell = ray.cell; beam.frac = ray.frac; beam.dir_low = ray.dir; beam.dir_high = ray.dir;
    beam.t_min = 0.0f; beam.t_max = 9.0f; beam.spread = 0.1f;
    ray.t_min = beam_start(dag, beam, stop);
    GridHit hit = trace_closest(dag, ray, stop);
    LampPatch lamp = facing_disc(vec3(0.0f, 1.0f, 0.0f), 0.1f, 9.0f);
    ray.t_min = beam_start(dag, lamp_bundle(ray, hit.face, lamp), stop);
    uint seed = pixel_seed(1u, 2u, 3u);
    ray = leave_hit(ray, hit, vec3(0.0f, 1.0f, 0.0f));
    int seen = lamp_samples_seen(dag, ray, hit.face, lamp, stop, 0, 4, seed) +
               sky_samples_seen(dag, ray, hit.face, lamp.centre, 9.0f, stop, 0, 4, seed);
    bool dark = seen == 0 && trace_any(dag, leave_hit(ray, hit, vec3(0.0f, 1.0f, 0.0f)), stop);
)";

std::string shared_text(std::initializer_list<const char*> files) {
    std::stringstream text;
    for (const char* file : files) text << std::ifstream(kSource + file).rdbuf() << '\n';
    return text.str();
}

/// Runs a compiler on this text and gives its exit status and output.
int compile(const std::string& command, const std::string& extension, const std::string& text,
            std::string& output) {
    const std::filesystem::path base =
        std::filesystem::temp_directory_path() /
        ("octavo_" + std::to_string(std::hash<std::string>()(text)) + "." + extension);
    std::ofstream(base) << text;
    const std::string log = base.string() + ".log";
    const int status = std::system((command + " " + base.string() + " > " + log + " 2>&1").c_str());
    std::stringstream read;
    read << std::ifstream(log).rdbuf();
    output = read.str();
    std::filesystem::remove(base);
    std::filesystem::remove(log);
    return status;
}

const std::string kGlslc = OCTAVO_GLSLC
    " -w -fshader-stage=compute --target-env=vulkan1.2 -o /dev/null -I" OCTAVO_SOURCE_DIR "/src";

TEST(SharedText, CompilesAsGlsl46Compute) {
    if (std::string(OCTAVO_GLSLC).empty()) GTEST_SKIP() << "no glslc";
    const std::string text =
        "#version 460\nlayout(local_size_x = 64) in;\n"
        "layout(std430, binding = 0) buffer Words { uint dag_words[]; };\n"
        "layout(std430, binding = 1) buffer Out { uint result[]; };\n" +
        shared_text({"trace/shared_text.h"}) +
        "struct DagView { int depth; };\n"
        "uint dag_load(DagView dag, uint word) { return dag_words[word]; }\n" +
        shared_text({"trace/traverse.h", "trace/beam.h", "light/sampling.h",
                     "render/ambient_occlusion.h", "light/shadow.h"}) +
        "void main() { DagView dag; dag.depth = 9;\n" + kUseAll +
        "result[gl_GlobalInvocationID.x] = hit.path.x + uint(dark); }\n";
    std::string output;
    EXPECT_EQ(compile(kGlslc, "comp", text, output), 0) << output;
}

/// The indented lines of a page below a heading that begins so.
std::string page_lines(const std::string& page, const std::string& heading) {
    std::ifstream lines(OCTAVO_SOURCE_DIR "/docs/" + page);
    std::string text;
    bool inside = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("## ")) inside = line.starts_with("## " + heading);
        if (inside && line.starts_with("    ")) text += line.substr(4) + '\n';
    }
    return text;
}

TEST(SharedText, CompilesInTheOrderOfThePageOnEmbedding) {
    if (std::string(OCTAVO_GLSLC).empty()) GTEST_SKIP() << "no glslc";
    const std::string lines = page_lines("embedding.md", "GLSL");
    ASSERT_NE(lines.find("cached_light.h"), std::string::npos) << lines;
    const std::string text =
        "#version 460\n#extension GL_GOOGLE_include_directive : require\n"
        "layout(local_size_x = 64) in;\n" +
        lines + "void main() {}\n";
    std::string output;
    EXPECT_EQ(compile(kGlslc, "comp", text, output), 0) << output;
}

TEST(SharedText, CompilesAsGlslEs300Fragment) {
    if (std::string(OCTAVO_GLSLANG).empty()) GTEST_SKIP() << "no glslangValidator (glslang-tools)";
    const std::string text =
        "#version 300 es\nprecision highp float;\nprecision highp int;\n"
        "precision highp usampler2D;\nuniform usampler2D dag_words;\nout vec4 color;\n" +
        shared_text({"trace/shared_text.h"}) +
        "struct DagView { int depth; };\n"
        "uint dag_load(DagView dag, uint word) {\n"
        "    return texelFetch(dag_words, ivec2(int(word & 4095u), int(word >> 12)), 0).x;\n}\n" +
        shared_text({"trace/traverse.h", "trace/beam.h", "light/sampling.h",
                     "render/ambient_occlusion.h", "light/shadow.h"}) +
        "void main() { DagView dag; dag.depth = 9;\n" + kUseAll +
        "color = vec4(hit.t, dark ? 1.0 : 0.0, 0.0, 1.0); }\n";
    std::string output;
    EXPECT_EQ(compile(OCTAVO_GLSLANG, "frag", text, output), 0) << output;
}

TEST(SharedTextSlow, CompilesAsCuda) {
    if (std::string(OCTAVO_NVCC).empty()) GTEST_SKIP() << "no nvcc";
    const std::string text =
        "#include \"octavo/trace/shared_text.h\"\n"
        "namespace octavo::shared { struct DagView { const uint* words; int depth; };\n"
        "OCTAVO_FN uint dag_load(DagView dag, uint word) { return dag.words[word]; } }\n"
        "#include \"octavo/trace/traverse.h\"\n#include \"octavo/trace/beam.h\"\n"
        "#include \"octavo/light/sampling.h\"\n#include \"octavo/render/ambient_occlusion.h\"\n"
        "#include \"octavo/light/shadow.h\"\n"
        "namespace octavo::shared { __global__ void run(DagView dag, uint* result) {\n" +
        kUseAll + "result[threadIdx.x] = hit.path.x + uint(dark); } }\n";
    std::string output;
    EXPECT_EQ(
        compile(OCTAVO_NVCC " -std=c++20 -fmad=false --expt-relaxed-constexpr -I" OCTAVO_SOURCE_DIR
                            "/src -cuda -o /dev/null",
                "cu", text, output),
        0)
        << output;
}

}  // namespace
}  // namespace octavo
