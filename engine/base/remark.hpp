#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "engine/base/text.hpp"

namespace palpate {

/// What somebody should know though nothing failed, to standard error: "palpate: ", the sentence on
/// one line, the end of the line. That nobody reads it is no error.
inline void remark(std::string_view sentence) {
    const std::string line = "palpate: " + plain(sentence) + '\n';
    static_cast<void>(std::fwrite(line.data(), 1, line.size(), stderr));
}

}  // namespace palpate
