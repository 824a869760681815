// SPDX-License-Identifier: MIT
#include "bench_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include "octavo/core/atomic_file.h"

namespace octavo::cli {
namespace {

constexpr double kWidth = 260, kHeight = 190, kLeft = 46, kTop = 48, kGap = 24, kBottom = 62;
constexpr std::array<std::string_view, 6> kColors = {"#1b6ca8", "#7aa6c2", "#d1495b",
                                                     "#edae49", "#66a182", "#555555"};

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text)
        out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
    return out;
}

/// A round step that makes four to eight of them up to `top`.
double grid_step(double top) {
    const double power = std::pow(10.0, std::floor(std::log10(top / 4.0)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (top / (factor * power) <= 8.0) return factor * power;
    return 10.0 * power;
}

class Svg {
public:
    void text(double x, double y, const std::string& what, std::string_view anchor,
              std::string_view more = "") {
        body_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x,
                             y, anchor, more, escaped(what));
    }
    void line(double x0, double y0, double x1, double y1, std::string_view color) {
        body_ += fmt::format(
            "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x0,
            y0, x1, y1, color);
    }
    void curve(const std::string& points, std::string_view color) {
        body_ += fmt::format(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"/>\n", points,
            color);
    }
    [[nodiscard]] std::string document(double width, double height) const {
        return fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
            "font-family=\"sans-serif\" font-size=\"11\">\n"
            "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{2}</svg>\n",
            width, height, body_);
    }

private:
    std::string body_;
};

void draw_panel(Svg& svg, double left, const PlotPanel& panel,
                const std::vector<std::string>& names) {
    double top = 1e-9;
    std::size_t frames = 1;
    for (const PlotPanel::Curve& curve : panel.curves) {
        for (const double value : curve.values) top = std::max(top, value);
        frames = std::max(frames, curve.values.size());
    }
    top *= 1.05;
    const auto y_of = [&](double value) { return kTop + kHeight * (1.0 - value / top); };
    const double step = grid_step(top);
    for (double value = 0.0; value <= top; value += step) {
        svg.line(left, y_of(value), left + kWidth, y_of(value), "#dddddd");
        svg.text(left - 5, y_of(value) + 4, fmt::format("{:g}", value), "end");
    }
    svg.text(left + kWidth / 2, kTop - 8, panel.title, "middle", " font-weight=\"bold\"");
    svg.text(left + kWidth / 2, kTop + kHeight + 16, fmt::format("frame 1 to {}", frames),
             "middle");
    for (const PlotPanel::Curve& curve : panel.curves) {
        std::string points;
        for (std::size_t i = 0; i < curve.values.size(); ++i)
            points +=
                fmt::format("{:.1f},{:.1f} ",
                            left + kWidth * static_cast<double>(i) /
                                       static_cast<double>(std::max<std::size_t>(frames - 1, 1)),
                            y_of(curve.values[i]));
        const auto color =
            static_cast<std::size_t>(std::ranges::find(names, curve.name) - names.begin());
        svg.curve(points, kColors[color % kColors.size()]);
    }
}

}  // namespace

void write_plot(const std::filesystem::path& file, const std::string& caption,
                const std::vector<PlotPanel>& panels) {
    std::vector<std::string> names;
    for (const PlotPanel& panel : panels)
        for (const PlotPanel::Curve& curve : panel.curves)
            if (std::ranges::find(names, curve.name) == names.end()) names.push_back(curve.name);
    Svg svg;
    svg.text(kLeft, 18, caption, "start", " font-size=\"12\"");
    svg.text(kLeft, 33, "MRays/s", "start");
    for (std::size_t i = 0; i < panels.size(); ++i)
        draw_panel(svg, kLeft + static_cast<double>(i) * (kWidth + kLeft + kGap), panels[i], names);
    double x = kLeft;
    const double y = kTop + kHeight + 42;
    for (std::size_t i = 0; i < names.size(); ++i) {
        svg.line(x, y - 4, x + 22, y - 4, kColors[i % kColors.size()]);
        svg.text(x + 27, y, names[i], "start");
        x += 48 + 7.0 * static_cast<double>(names[i].size());
    }
    const std::string document = svg.document(
        static_cast<double>(panels.size()) * (kWidth + kLeft + kGap), kTop + kHeight + kBottom);
    AtomicFile out(file);
    out.write(0, std::as_bytes(std::span(document)));
    out.commit();
}

}  // namespace octavo::cli
