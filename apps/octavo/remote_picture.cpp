// SPDX-License-Identifier: MIT
#include "remote_picture.h"

#include <turbojpeg.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "light_arguments.h"
#include "octavo/io/octv.h"
#include "octavo/mesh/png.h"
#include "octavo/render/image.h"
#include "octavo/trace/trace.h"
#include "sky_arguments.h"

namespace octavo::cli {
namespace {

constexpr int kMostSide = 4096;
constexpr std::size_t kMostPages = 256;
constexpr std::int64_t kAllLights = -2;  // of a wish

using Json = nlohmann::json;

dvec3 read_vec3(const Json& json, const char* key) {
    const Json& list = json.at(key);
    if (!list.is_array() || list.size() != 3)
        throw Error(Errc::bad_argument, std::string(key) + " does not have three numbers");
    return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

/// @param rgb      3 bytes a pixel
/// @param quality  of JPEG; 0: PNG
std::string encode(const std::vector<std::uint8_t>& rgb, int width, int height, int quality) {
    if (quality == 0) {
        const std::vector<std::byte> png = encode_png(rgb, width, height, PngChannels::rgb);
        return {reinterpret_cast<const char*>(png.data()), png.size()};
    }
    const std::unique_ptr<void, int (*)(tjhandle)> encoder(tjInitCompress(), tjDestroy);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    const int failed = tjCompress2(encoder.get(), rgb.data(), width, 0, height, TJPF_RGB, &bytes,
                                   &size, TJSAMP_444, quality, TJFLAG_FASTDCT);
    const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(bytes, tjFree);
    if (failed != 0) throw Error(Errc::limit, "the picture cannot be encoded as JPEG");
    return {reinterpret_cast<const char*>(bytes), size};
}

std::string with_length(const std::string& bytes) {
    std::string framed;
    for (std::size_t shift = 0; shift < 32; shift += 8)
        framed += static_cast<char>(bytes.size() >> shift & 0xff);
    return framed + bytes;
}

void refuse(httplib::Response& response, const char* why) {
    response.status = 400;
    response.set_content(why, "text/plain; charset=utf-8");
}

std::optional<PlainMode> read_mode(const Json& json) {
    const std::string mode = json.at("mode").get<std::string>();
    if (mode == "normals") return PlainMode::normals;
    if (mode == "levels") return PlainMode::levels;
    if (mode == "steps") return PlainMode::steps;
    if (mode == "color") return PlainMode::color;
    if (mode != "shaded") throw Error(Errc::bad_argument, "there is no such mode");
    return std::nullopt;
}

}  // namespace

/// The frames of one wish: each costs some times the one before.
struct RemotePicture::Stage {
    int divisor;  // of the picture's sides
    int samples;
    int ao_samples;
    int shadow_samples;
    int jpeg_quality;  // 0: PNG

    [[nodiscard]] int part_of(int side) const { return std::max(1, side / divisor); }
};

RemotePicture::RemotePicture(const std::filesystem::path& file)
    : file_(file), model_(read_octv(file)) {
    bounds_ = framed_box(model_.dag, model_.grid());
    device_ = open_device("auto");
    on_device_ = device_->upload(model_.dag, model_.attributes, model_.light);
}

nlohmann::json RemotePicture::config() const {
    const auto list = [](const dvec3& v) { return Json::array({v.x, v.y, v.z}); };
    return {{"url", "render"},
            {"pick", "pick"},
            {"low", list(bounds_.low)},
            {"high", list(bounds_.high)}};
}

RemotePicture::Wish RemotePicture::parse(const std::string& body) const {
    const Json json = Json::parse(body);
    Wish wish;
    wish.page = json.at("page").get<std::string>();
    wish.number = json.at("number").get<std::uint64_t>();
    wish.exposure = json.at("exposure").get<double>();
    if (wish.page.size() > 64 || !(std::abs(wish.exposure) <= 32.0))
        throw Error(Errc::bad_argument, "out of range");

    RenderOptions& options = wish.options;
    options.width = json.at("width").get<int>();
    options.height = json.at("height").get<int>();
    if (options.width < 1 || options.width > kMostSide || options.height < 1 ||
        options.height > kMostSide)
        throw Error(Errc::bad_argument, "a picture's sides are 1 to 4096 pixels");
    options.up = read_vec3(json, "up");
    const dvec3 eye = read_vec3(json, "eye");
    options.camera =
        look_along(eye, read_vec3(json, "forward"), options.up, json.at("fov").get<double>());
    const std::string shadows = json.at("shadows").get<std::string>();
    options.shadows = shadows == "none"   ? Shadows::none
                      : shadows == "hard" ? Shadows::hard
                                          : Shadows::soft;
    options.ao_samples = json.at("ambient").get<bool>() ? 1 : 0;
    options.ao_radius = json.at("reach").get<double>();
    options.smooth_normals = json.at("smooth").get<bool>();
    const int level = json.at("level").get<int>();
    const double detail = json.at("detail").get<double>();
    if (!(detail >= 0.0 && detail <= 64.0)) throw Error(Errc::bad_argument, "out of range");
    options.level_of_detail = detail > 0.0;
    if (const std::optional<PlainMode> mode = read_mode(json)) {
        wish.plain = PlainOptions{.mode = *mode,
                                  .width = options.width,
                                  .height = options.height,
                                  .camera = *options.camera,
                                  .up = options.up,
                                  .smooth = options.smooth_normals,
                                  .level = level,
                                  .detail = detail};
        return wish;
    }

    if (!model_.attributes.empty()) options.attributes = &model_.attributes;
    wish.stored = json.at("stored").get<bool>() && model_.metadata.light && !model_.light.empty();
    if (wish.stored) options.sky = parse_stored_sky(model_.metadata.light->sky, options.up, file_);

    const auto light = json.at("light").get<std::int64_t>();
    const std::vector<Light>& stored = model_.metadata.lights;
    if (light == kAllLights && !stored.empty()) {
        options.lights = balanced(stored, bounds_);
    } else if (light >= 0 && static_cast<std::uint64_t>(light) < stored.size()) {
        // Alone, a light is as bright as all of them are together.
        options.lights = balanced({stored[static_cast<std::size_t>(light)]}, bounds_);
    } else {
        Light sun = sun_at(json.at("azimuth").get<double>(), json.at("elevation").get<double>(),
                           options.up);
        sun.size = json.at("size").get<double>();
        options.lights = {sun};
    }
    return wish;
}

std::string RemotePicture::draw(const Wish& wish, const Stage& stage) {
    if (wish.plain) return draw_plain(wish, stage);
    RenderOptions options = wish.options;
    options.width = stage.part_of(options.width);
    options.height = stage.part_of(options.height);
    options.samples = stage.samples;
    options.ao_samples *= stage.ao_samples;
    options.shadow_samples = stage.shadow_samples;
    const Image image = wish.stored ? device_->render_cached(*on_device_, model_.grid(), options)
                                    : device_->render(*on_device_, model_.grid(), options);
    return encode(screen_pixels(image, wish.exposure), image.width, image.height,
                  stage.jpeg_quality);
}

std::string RemotePicture::draw_plain(const Wish& wish, const Stage& stage) {
    PlainOptions options = *wish.plain;
    options.width = stage.part_of(options.width);
    options.height = stage.part_of(options.height);
    options.samples = stage.samples;
    options.detail /= stage.divisor;  // of the same cells
    const std::vector<std::uint8_t> rgb =
        plain_picture(model_, options, [&] { return is_wanted(wish); });
    return rgb.empty() ? std::string()
                       : encode(rgb, options.width, options.height, stage.jpeg_quality);
}

bool RemotePicture::is_wanted(const Wish& wish) {
    if (stopped_) return false;
    const std::lock_guard lock(wishes_mutex_);
    const auto found = newest_.find(wish.page);
    return found == newest_.end() || found->second <= wish.number;
}

void RemotePicture::render(const std::string& body, httplib::Response& response) {
    auto wish = std::make_shared<Wish>();
    try {
        *wish = parse(body);
    } catch (const std::exception& error) {
        return refuse(response, error.what());
    }
    {
        const std::lock_guard lock(wishes_mutex_);
        if (newest_.size() >= kMostPages) newest_.clear();
        std::uint64_t& newest = newest_[wish->page];
        newest = std::max(newest, wish->number);
    }
    wish->options.progress = [this, wish = wish.get()](const Progress&) {
        return is_wanted(*wish);
    };
    response.set_chunked_content_provider(
        "application/octet-stream", [this, wish](std::size_t, httplib::DataSink& sink) {
            try {
                static constexpr Stage kStages[] = {
                    {4, 1, 4, 1, 70}, {1, 1, 8, 2, 85}, {1, 4, 16, 4, 92}, {1, 16, 64, 16, 0}};
                for (const Stage& stage : kStages) {
                    const std::lock_guard one_at_a_time(drawing_);
                    if (!is_wanted(*wish)) break;
                    const std::string frame = draw(*wish, stage);
                    if (frame.empty()) break;
                    const std::string framed = with_length(frame);
                    if (!sink.write(framed.data(), framed.size())) return false;
                }
            } catch (const Error& error) {
                if (error.code() != Errc::cancelled) return false;
            } catch (const std::exception&) {  // no memory: the answer ends here
                return false;
            }
            sink.done();
            return true;
        });
}

void RemotePicture::pick(const std::string& body, httplib::Response& response) const {
    Ray ray;
    try {
        const Json json = Json::parse(body);
        ray.origin = read_vec3(json, "eye");
        ray.direction = read_vec3(json, "direction");
    } catch (const std::exception& error) {
        return refuse(response, error.what());
    }
    Json answer;
    if (const Hit hit = trace_closest(model_.dag, model_.grid(), ray)) {
        answer = {{"path", {hit.path.x, hit.path.y, hit.path.z}},
                  {"height", model_.grid().depth - hit.level},
                  {"face", static_cast<int>(hit.face)},
                  {"time", hit.t}};
        const auto list = [](const vec3& v) { return Json::array({v.x, v.y, v.z}); };
        const vec3 towards(-ray.direction);
        if (const auto albedo = model_.attributes.albedo(hit.path, hit.level, towards))
            answer["albedo"] = list(*albedo);
        const auto emission = model_.attributes.emission(hit.path, hit.level, towards);
        if (emission && *emission != vec3(0.0f)) answer["emission"] = list(*emission);
    }
    response.set_content(answer.dump(), "application/json");
}

}  // namespace octavo::cli
