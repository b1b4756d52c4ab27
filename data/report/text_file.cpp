#include "data/report/text_file.hpp"

#include <fstream>
#include <stdexcept>

namespace palpate::data {

void write_text_file(const std::filesystem::path& path, std::string_view text) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    file.close();
    if (!file) {
        throw std::runtime_error("cannot write " + path.string() +
                                 ": is its folder there, writable and not full?");
    }
}

}  // namespace palpate::data
