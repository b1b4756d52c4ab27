#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/file/schema.hpp"
#include "protocols/protocol/observer_model.hpp"

/// Observer files: who the simulated participants are.
namespace palpate::protocols {

/// Reads an observer. A table or a key that is left out is as ObserverModel begins.
/// @param file_name  for messages only
/// @throws ProtocolError
[[nodiscard]] ObserverModel parse_observer(std::string_view text, std::string_view file_name);

/// parse_observer() of a file's text; "typical" where no such file is: typical_observer().
[[nodiscard]] ObserverModel load_observer(const std::filesystem::path& file);

/// The canonical text, every key; parse_observer() of it gives the same model.
[[nodiscard]] std::string observer_text(const ObserverModel& model);

/// The model to begin with: people who differ by some 0.8 logit in how often they are right, learn
/// a little, and whom friction does nothing but what its force does.
[[nodiscard]] ObserverModel typical_observer();
/// Its text, what each key means beside it.
[[nodiscard]] std::string observer_example();

/// What such a file may say, key by key: for --keys and docs.
[[nodiscard]] std::vector<TableText> observer_reference();

}  // namespace palpate::protocols
