#pragma once

#include <string>

#include "tests/support/slurp.hpp"

namespace palpate::tests {

/// What a file of tests/texts holds: studies, scripts and tables that tests are given.
inline std::string test_text(const std::string& name) {
    return slurp(PALPATE_SOURCE_DIR "/tests/texts/" + name);
}

}  // namespace palpate::tests
