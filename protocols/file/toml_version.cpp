#include "protocols/file/toml_version.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

namespace palpate::protocols {

std::string toml_version() {
    return fmt::format("{}.{}.{}", TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH);
}

}  // namespace palpate::protocols
