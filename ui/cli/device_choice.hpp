#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace palpate::ui {

/// What --device asks for.
struct DeviceChoice {
    enum class Kind : std::uint8_t { simulated, mouse, replay } kind = Kind::simulated;
    std::string file;                   ///< replay: the database
    std::optional<std::int64_t> trial;  ///< replay: trial id; none: the file's trials in turn
};

/// `sim`, `mouse`, `replay:FILE` or `replay:FILE:TRIAL`. A FILE may hold colons: only a last part that
/// is a number is a trial.
/// @throws std::invalid_argument naming the value and the choices
[[nodiscard]] DeviceChoice parse_device(std::string_view text);

}  // namespace palpate::ui
