// SPDX-License-Identifier: MIT
#include "help.h"

#include <memory>
#include <utility>

namespace octavo::cli {
namespace {

/// The library leaves two lines empty between groups, and some at the end.
std::string without_gaps(std::string text) {
    for (std::size_t gap; (gap = text.find("\n\n\n")) != std::string::npos;) text.erase(gap, 1);
    while (text.ends_with("\n\n")) text.pop_back();
    return text;
}

class ExamplesFirst : public CLI::Formatter {
public:
    explicit ExamplesFirst(std::string examples) : examples_(std::move(examples)) {
        column_width(30);
        label("TEXT", "");
        label("REQUIRED", "(required)");
    }

    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode mode) const override {
        name = app->get_name();
        for (const CLI::App* above = app->get_parent(); above; above = above->get_parent())
            name.insert(0, above->get_name() + " ");
        return "Examples:\n" + examples_ + "\n" +
               without_gaps(Formatter::make_help(app, std::move(name), mode));
    }

private:
    std::string examples_;
};

}  // namespace

void set_help(CLI::App& command, std::string examples) {
    command.formatter(std::make_shared<ExamplesFirst>(std::move(examples)));
    command.set_help_flag("-h,--help", "Print this");
}

void begin_group(CLI::App& command, const std::string& heading) {
    command.option_defaults()->group(heading);
}

}  // namespace octavo::cli
