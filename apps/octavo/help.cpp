// SPDX-License-Identifier: MIT
#include "help.h"

#include <memory>
#include <utility>

namespace octavo::cli {
namespace {

class ExamplesFirst : public CLI::Formatter {
public:
    explicit ExamplesFirst(std::string examples) : examples_(std::move(examples)) {
        column_width(30);
        label("TEXT", "");
        label("REQUIRED", "(required)");
    }

    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode mode) const override {
        if (const CLI::App* program = app->get_parent())
            name = program->get_name() + " " + app->get_name();
        return "Examples:\n" + examples_ + "\n" + Formatter::make_help(app, std::move(name), mode);
    }

private:
    std::string examples_;
};

}  // namespace

void set_help(CLI::App& command, std::string examples) {
    command.formatter(std::make_shared<ExamplesFirst>(std::move(examples)));
    command.set_help_flag("-h,--help", "Print this");
}

}  // namespace octavo::cli
