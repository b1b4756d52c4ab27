#pragma once

#include <string>
#include <string_view>

/// Names that no two sessions share, wherever they were recorded: RFC 9562, 36 characters, lower case.
namespace palpate::data {

/// Random, version 4. From the kernel's generator: never the same twice.
[[nodiscard]] std::string random_uuid();

/// Version 8: the first 128 bits of the SHA-256 of `name`, but for the six that RFC 9562 sets. The same for
/// the same name, so that two copies of one old file agree.
[[nodiscard]] std::string derived_uuid(std::string_view name);

}  // namespace palpate::data
