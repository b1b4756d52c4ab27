#include "ui/command/beside.hpp"

#include <stdexcept>

#include "engine/base/refuse.hpp"

namespace palpate::ui {

std::filesystem::path beside_program(std::string_view name, std::string_view target) {
    std::error_code unknown;
    const auto folder = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
    auto file = folder / name;
    if (!std::filesystem::exists(file)) {
        file = folder.parent_path() / "lib" / "palpate" / name;
    }
    refuse_if<std::runtime_error>(unknown || !std::filesystem::exists(file),
                                  "{} is not there, nor beside the program: build the target {}",
                                  file.string(), target);
    return file;
}

}  // namespace palpate::ui
