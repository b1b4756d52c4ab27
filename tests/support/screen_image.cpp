#include <png.h>

#include "tests/support/x_hand.hpp"

namespace palpate::tests {

ScreenImage read_png(const std::string& file) {
    png_image read{};
    read.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_file(&read, file.c_str()) == 0) {
        throw std::runtime_error(file + ": " + read.message);
    }
    read.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(read));
    if (png_image_finish_read(&read, nullptr, bytes.data(), 0, nullptr) == 0) {
        throw std::runtime_error(file + ": " + read.message);
    }
    ScreenImage image{.width = static_cast<int>(read.width),
                      .height = static_cast<int>(read.height)};
    for (std::size_t i = 0; i + 2 < bytes.size(); i += 3) {
        image.pixels.push_back(static_cast<std::uint32_t>(bytes[i]) << 16U |
                               static_cast<std::uint32_t>(bytes[i + 1]) << 8U | bytes[i + 2]);
    }
    return image;
}

}  // namespace palpate::tests
