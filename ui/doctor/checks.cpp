#include "ui/doctor/checks.hpp"

#include <algorithm>
#include <array>
#include <exception>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "data/csv/json_text.hpp"

namespace palpate::ui {
namespace {

constexpr std::size_t kNameWidth = 20;
/// Where detail, remedy and picture begin.
constexpr std::size_t kIndent = 6 + kNameWidth + 1;
constexpr std::size_t kWidth = 100;

/// `text` in lines of at most kWidth - `indent` characters, the later ones indented.
std::string wrapped(std::string_view text, std::size_t indent) {
    std::string out;
    std::size_t column = indent;
    while (!text.empty()) {
        const std::size_t space = text.find(' ');
        const std::string_view word = text.substr(0, space);
        if (column > indent && column + 1 + word.size() > kWidth) {
            out += '\n' + std::string(indent, ' ');
            column = indent;
        } else if (column > indent) {
            out += ' ';
            ++column;
        }
        out += word;
        column += word.size();
        text.remove_prefix(space == std::string_view::npos ? text.size() : space + 1);
    }
    return out;
}

}  // namespace

Check guarded(const std::string& name, const std::function<Check()>& look) noexcept {
    try {
        return look();
    } catch (const std::exception& e) {
        return {.name = name, .status = CheckStatus::fail, .detail = e.what()};
    }
}

bool any_fails(const std::vector<Check>& checks) noexcept {
    return std::ranges::count(checks, CheckStatus::fail, &Check::status) > 0;
}

std::string_view to_string(CheckStatus status) noexcept {
    constexpr std::array<std::string_view, 3> kWords{"ok", "warn", "fail"};
    return kWords[static_cast<std::size_t>(status)];
}

std::string as_text(const Check& check) {
    std::string out = fmt::format("{:<6}{:<{}} {}\n", to_string(check.status), check.name,
                                  kNameWidth, wrapped(check.detail, kIndent));
    if (!check.remedy.empty()) {
        out += fmt::format("{:{}}-> {}\n", "", kIndent, wrapped(check.remedy, kIndent + 3));
    }
    for (const std::string& line : check.picture) {
        out += fmt::format("{:{}}{}\n", "", kIndent, line);
    }
    return out;
}

std::string verdict(const std::vector<Check>& checks) {
    const auto count = [&](CheckStatus status) {
        return std::ranges::count(checks, status, &Check::status);
    };
    return fmt::format("{} ok, {} to look at, {} failed\n", count(CheckStatus::ok),
                       count(CheckStatus::warn), count(CheckStatus::fail));
}

std::string as_json(std::string_view version, const std::vector<Check>& checks) {
    data::Json list = data::Json::array();
    for (const Check& check : checks) {
        data::Json numbers = data::Json::object();
        for (const auto& [name, value] : check.numbers) {
            numbers[name] = value;
        }
        list.push_back({{"name", check.name},
                        {"status", to_string(check.status)},
                        {"detail", check.detail},
                        {"remedy", check.remedy},
                        {"numbers", numbers}});
    }
    return data::json_text({{"palpate", version}, {"checks", list}}) + "\n";
}

}  // namespace palpate::ui
