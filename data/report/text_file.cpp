#include "data/report/text_file.hpp"

#include "data/csv/whole_file.hpp"

namespace palpate::data {

void write_text_file(const std::filesystem::path& path, std::string_view text) {
    write_whole(path, text);  // whose empty path would be standard output
}

}  // namespace palpate::data
