// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstring>
#include <random>

#include "harness.h"
#include "octavo/attributes/attributes.h"
#include "octavo/attributes/cell_light.h"
#include "octavo/attributes/cell_values_writer.h"
#include "octavo/dag/dag.h"
#include "octavo/dag/statistics.h"
#include "octavo/io/compression.h"
#include "octavo/io/metadata.h"
#include "octv_parts.h"

namespace octavo::fuzz {
namespace {

using octv::Section;

/// Numbers that do not depend on the standard library.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    std::uint32_t below(std::uint64_t limit) {
        return limit == 0 ? 0 : static_cast<std::uint32_t>(engine_() % limit);
    }
    bool once_in(std::uint32_t n) { return below(n) == 0; }
    std::uint64_t word64() { return std::uint64_t{engine_()} << 32 | engine_(); }

private:
    std::mt19937 engine_;
};

std::string text_of(std::span<const std::uint32_t> words) {
    return {reinterpret_cast<const char*>(words.data()), words.size_bytes()};
}

std::vector<std::uint32_t> words_of(const std::string& content) {
    std::vector<std::uint32_t> words(content.size() / 4);
    if (!words.empty()) std::memcpy(words.data(), content.data(), 4 * words.size());
    return words;
}

std::string compressed(const std::string& raw) {
    std::string frame;
    zstd_compress(
        std::as_bytes(std::span(raw)),
        [&](std::span<const std::byte> piece) {
            frame.append(reinterpret_cast<const char*>(piece.data()), piece.size());
        },
        [](std::uint64_t) {});
    return frame;
}

Light random_light(Random& random) {
    const auto number = [&] { return static_cast<double>(random.below(2000)) / 100.0 - 10.0; };
    const auto point = [&] { return dvec3(number(), number(), number()); };
    Light light;
    light.name = std::string(1, 'a');
    light.kind = static_cast<Light::Kind>(random.below(6));
    light.position = point();
    light.direction = random.once_in(8) ? dvec3(0.0) : point();
    light.intensity = random.once_in(8) ? vec3(-1.0f, 1e30f, 0.0f) : vec3(1.0f);
    light.size = random.once_in(2) ? 0.0 : std::abs(number());
    light.inner_angle = number();
    light.outer_angle = number();
    light.half_u = point();
    light.half_v = random.once_in(4) ? dvec3(0.0) : point();
    for (std::uint32_t i = random.below(4); light.kind == Light::Kind::mesh && i > 0; --i)
        light.triangles.push_back({point(), point(), random.once_in(4) ? dvec3(1e300) : point()});
    return light;
}

/// Values of all forms for the cells of some level, where there are few enough of them.
void add_attributes(const Dag& dag, Metadata& metadata, OctvParts& parts, Random& random) {
    constexpr std::uint64_t kMostCells = 3000;
    int level = 2 + static_cast<int>(random.below(static_cast<unsigned>(dag.depth() - 1)));
    while (level > 2 && CellIndex(dag, level).count() > kMostCells) --level;
    const std::uint64_t cells = CellIndex(dag, level).count();
    if (cells > kMostCells) return;
    metadata.attributes = {level, cells, static_cast<int>(random.below(256))};
    for (std::size_t c = 0; c < Attributes::kChannels; ++c) {
        if (random.once_in(3)) continue;
        CellValuesWriter writer(Attributes::kValueBits[c], 0);
        std::vector<std::uint32_t> values;
        const std::uint32_t colors = 1u << random.below(10);
        const std::uint32_t mask = 0xffffffffu >> (32 - Attributes::kValueBits[c]);
        for (std::uint64_t i = 0; i < cells; ++i)
            values.push_back(random.below(colors) * 0x9e3779b1u & mask);
        writer.append(values);
        parts.set(octv::kAttributeSections[c], 0, text_of(std::move(writer).finish().words()));
    }
    if (random.once_in(2)) return;
    std::vector<std::uint32_t> light(6 * cells);
    for (std::uint32_t& word : light)
        word = random.once_in(5) ? CellLight::kHidden : static_cast<std::uint32_t>(random.word64());
    metadata.light =
        LightSummary{static_cast<int>(random.below(9)), {random_light(random)}, "none"};
    parts.set(octv::kLightSection, 0, text_of(light));
}

std::vector<std::uint8_t> file_of(int depth, const std::vector<std::uint64_t>& begins,
                                  const std::vector<std::uint32_t>& words, Statistics statistics,
                                  Random* looks = nullptr) {
    Metadata metadata;
    metadata.source = "random";
    metadata.grid = {.origin = {-1.0, 2.0, 0.5}, .voxel_size = 0.25, .depth = depth};
    metadata.statistics = std::move(statistics);
    OctvParts parts;
    parts.set(octv::kMetadataSection, octv::kRequired, "");
    parts.set(octv::kDagSection, octv::kRequired, text_of(words));
    if (looks != nullptr) {
        for (std::uint32_t i = looks->below(3); i > 0; --i)
            metadata.lights.push_back(random_light(*looks));
        add_attributes(Dag(depth, begins, words), metadata, parts, *looks);
    }
    parts.find(octv::kMetadataSection)->content = encode_metadata(metadata);
    return parts.sealed();
}

/// Changes one word so that it is likely to be nearly right.
void change_word(std::vector<std::uint32_t>& words, Random& random) {
    if (words.empty()) return;
    const std::size_t at = random.below(words.size());
    const std::array<std::uint32_t, 8> choices = {words[at] + 1,
                                                  words[at] - 1,
                                                  words[at] ^ (1u << random.below(32)),
                                                  random.below(256),
                                                  random.below(words.size() + 2),
                                                  words[random.below(words.size())],
                                                  0u,
                                                  static_cast<std::uint32_t>(random.word64())};
    words[at] = choices[random.below(choices.size())];
}

/// Replaces a number of the JSON text by another.
void change_number(std::string& text, Random& random) {
    std::vector<std::size_t> digits;
    for (std::size_t i = 0; i < text.size(); ++i)
        if (text[i] >= '0' && text[i] <= '9') digits.push_back(i);
    if (digits.empty()) return;
    const std::size_t at = digits[random.below(digits.size())];
    static constexpr std::array<const char*, 10> kNumbers = {
        "0",     "1", "-1", "18446744073709551615", "9007199254740993", "1e308", "2251799813685248",
        "1e999", "3", "17"};
    if (random.once_in(2))
        text[at] = static_cast<char>('0' + random.below(10));
    else
        text.replace(at, 1, kNumbers[random.below(kNumbers.size())]);
}

/// Changes the table as it stands, sizes and offsets among it.
std::vector<std::uint8_t> change_table(std::vector<std::uint8_t> file, Random& random) {
    const std::size_t size = std::min<std::size_t>(file.size(), 64 + 3 * sizeof(Section));
    if (size == 0) return file;
    const std::size_t at = random.below(size) / 4 * 4;
    if (at + 4 > file.size()) return file;
    const std::array<std::uint32_t, 6> choices = {
        0u, 1u, 4096u, 0xffffffffu, 0x80000000u, static_cast<std::uint32_t>(random.word64())};
    const std::uint32_t word = choices[random.below(choices.size())];
    std::memcpy(file.data() + at, &word, 4);
    if (!random.once_in(4)) seal_directory(file);
    return file;
}

}  // namespace

std::vector<std::uint8_t> random_octv(std::uint32_t seed, bool truthful) {
    Random random(seed);
    const int depth = 2 + static_cast<int>(random.below(16));
    const int leaf_level = depth - 2;
    // Nodes by level: no more than pointers lead there, so that each gets one.
    std::vector<std::uint32_t> counts = {1};

    // Masks first, as they decide where everything lies.
    std::vector<std::vector<std::uint32_t>> masks(static_cast<std::size_t>(leaf_level));
    std::vector<std::uint64_t> begins;
    std::vector<std::vector<std::uint32_t>> node_words_of_level;
    std::uint64_t word = 0;
    for (int level = 0; level < leaf_level; ++level) {
        begins.push_back(word);
        std::vector<std::uint32_t> at;
        for (std::uint32_t i = 0; i < counts[static_cast<std::size_t>(level)]; ++i) {
            const std::uint32_t mask = random.once_in(4) ? 255u : 1 + random.below(255);
            masks[static_cast<std::size_t>(level)].push_back(mask);
            at.push_back(static_cast<std::uint32_t>(word));
            word += static_cast<std::uint64_t>(node_words(mask));
        }
        const std::uint64_t pointers = word - begins.back() - at.size();
        counts.push_back(1 + random.below(std::min<std::uint64_t>(6, pointers)));
        node_words_of_level.push_back(at);
    }
    begins.push_back(word);
    std::vector<std::uint32_t> leaves;
    for (std::uint32_t i = 0; i < counts.back(); ++i)
        leaves.push_back(static_cast<std::uint32_t>(word) + 2 * i);
    node_words_of_level.push_back(leaves);
    word += 2 * counts.back();
    begins.push_back(word);

    std::vector<std::uint32_t> words;
    for (int level = 0; level < leaf_level; ++level) {
        const auto& targets = node_words_of_level[static_cast<std::size_t>(level) + 1];
        std::size_t pointer = 0;
        for (const std::uint32_t mask : masks[static_cast<std::size_t>(level)]) {
            words.push_back(mask);
            for (int i = 1; i < node_words(mask); ++i)
                words.push_back(pointer < targets.size() ? targets[pointer++]
                                                         : targets[random.below(targets.size())]);
        }
    }
    for (std::uint32_t i = 0; i < counts.back(); ++i) {
        const std::uint64_t leaf = random.once_in(3)   ? ~std::uint64_t{0}
                                   : random.once_in(2) ? std::uint64_t{1} << random.below(64)
                                                       : random.word64() | 1;
        words.push_back(static_cast<std::uint32_t>(leaf));
        words.push_back(static_cast<std::uint32_t>(leaf >> 32));
    }
    Statistics statistics = compute_statistics(Dag(depth, begins, words));
    if (!truthful) statistics.voxels = random.below(64);
    return file_of(depth, begins, words, statistics, random.once_in(3) ? nullptr : &random);
}

std::vector<std::uint8_t> full_octv(int depth, int attribute_level, bool compress) {
    std::vector<std::uint64_t> begins;
    std::vector<std::uint32_t> words;
    for (int level = 0; level < depth - 2; ++level) {
        begins.push_back(words.size());
        words.push_back(255);
        const auto next = static_cast<std::uint32_t>(words.size() + 8);
        words.insert(words.end(), 8, next);
    }
    begins.push_back(words.size());
    words.insert(words.end(), 2, 0xffffffffu);
    begins.push_back(words.size());
    auto file = file_of(depth, begins, words, compute_statistics(Dag(depth, begins, words)));
    if (attribute_level == 0) return file;

    OctvParts parts(file);
    std::string& json = parts.find(octv::kMetadataSection)->content;
    Metadata metadata = decode_metadata(json);
    const std::uint64_t cells = std::uint64_t{1} << 3 * attribute_level;
    metadata.attributes = {attribute_level, cells, 0};
    json = encode_metadata(metadata);
    std::vector<std::uint32_t> table(CellValues::kHeaderWords + (cells + 255) / 256);
    table[0] = 24;
    table[1] = static_cast<std::uint32_t>(table.size()) - CellValues::kHeaderWords;
    const std::string raw = text_of(table);
    parts.set(octv::kAttributeSections[0], compress ? octv::kZstd : 0,
              compress ? compressed(raw) : raw);
    parts.find(octv::kAttributeSections[0])->section.raw_bytes = raw.size();
    return parts.sealed();
}

std::vector<std::uint8_t> mutate_octv(Bytes file, std::uint32_t seed,
                                      std::size_t (*mutate_bytes)(std::uint8_t*, std::size_t,
                                                                  std::size_t)) {
    Random random(seed);
    if (random.once_in(16)) return random_octv(seed, !random.once_in(4));
    OctvParts parts(file);
    OctvParts::Part* dag = parts.find(octv::kDagSection);
    OctvParts::Part* metadata = parts.find(octv::kMetadataSection);
    if (!dag || !metadata) return random_octv(seed, true);

    const auto blindly = [&](std::string& content) {
        const std::size_t size = content.size();
        content.resize(size + 64);
        content.resize(
            mutate_bytes(reinterpret_cast<std::uint8_t*>(content.data()), size, content.size()));
    };
    std::vector<OctvParts::Part*> looks;
    for (OctvParts::Part& part : parts.parts)
        if (&part != dag && &part != metadata) looks.push_back(&part);
    if (!looks.empty() && random.once_in(3)) {
        OctvParts::Part& part = *looks[random.below(looks.size())];
        std::vector<std::uint32_t> words = words_of(part.content);
        switch (random.below(5)) {
            case 0:
                blindly(part.content);
                break;
            case 1:
                part.section.id = octv::kAttributeSections[random.below(6)];
                break;
            case 2:
                words.resize(random.below(words.size() + 8));
                part.content = text_of(words);
                break;
            default:
                for (std::uint32_t i = 1 + random.below(3); i > 0; --i) {
                    // The table and the forms of blocks come first.
                    if (random.once_in(2)) {
                        change_word(words, random);
                    } else {
                        std::vector<std::uint32_t> front(
                            words.begin(), words.begin() + static_cast<long>(std::min<std::size_t>(
                                                               24, words.size())));
                        change_word(front, random);
                        std::ranges::copy(front, words.begin());
                    }
                }
                part.content = text_of(words);
        }
        return parts.sealed();
    }
    switch (random.below(8)) {
        case 0:
        case 1:
        case 2: {
            std::vector<std::uint32_t> words = words_of(dag->content);
            for (std::uint32_t i = 1 + random.below(3); i > 0; --i) change_word(words, random);
            dag->content = text_of(words);
            break;
        }
        case 3:
            change_number(metadata->content, random);
            break;
        case 4:
            blindly(metadata->content);
            break;
        case 5:
            blindly(dag->content);
            break;
        case 6:
            if (!(dag->section.flags & octv::kZstd) && !dag->content.empty()) {
                dag->section.flags |= octv::kZstd;
                dag->section.raw_bytes = dag->content.size();
                dag->content = compressed(dag->content);
            } else {
                blindly(dag->content);
            }
            break;
        default:
            return change_table(parts.sealed(), random);
    }
    return parts.sealed();
}

}  // namespace octavo::fuzz
