#include "data/page/tick_text.hpp"

namespace palpate::data {
namespace {

void put(std::string& bytes, std::uint64_t number) {
    while (number > 127) {
        bytes += static_cast<char>(number % 128 + 128);
        number /= 128;
    }
    bytes += static_cast<char>(number);
}

std::string bytes_of(std::span<const std::int64_t> values, int order) {
    std::string bytes(1, static_cast<char>(order));
    std::int64_t last = 0;
    std::int64_t before = 0;
    std::uint64_t zeros = 0;
    const auto end_zeros = [&] {
        if (zeros > 0) {
            put(bytes, 0);
            put(bytes, zeros - 1);
            zeros = 0;
        }
    };
    for (const std::int64_t value : values) {
        const std::int64_t guess = order == 0 ? 0 : order == 1 ? last : 2 * last - before;
        const std::int64_t rest = value - guess;
        before = last;
        last = value;
        if (rest == 0) {
            ++zeros;
            continue;
        }
        end_zeros();
        put(bytes, rest < 0 ? 2 * static_cast<std::uint64_t>(-(rest + 1)) + 1
                            : 2 * static_cast<std::uint64_t>(rest));
    }
    end_zeros();
    return bytes;
}

}  // namespace

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::string_view three = bytes.substr(i, 3);
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            bits = bits << 8U | (k < three.size() ? static_cast<unsigned char>(three[k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            out += k <= three.size() ? kDigits[bits >> (18U - 6U * k) & 63U] : '=';
        }
    }
    return out;
}

std::string tick_text(std::span<const std::int64_t> values) {
    std::string best = bytes_of(values, 0);
    for (const int order : {1, 2}) {
        std::string other = bytes_of(values, order);
        if (other.size() < best.size()) {
            best = std::move(other);
        }
    }
    return base64(best);
}

}  // namespace palpate::data
