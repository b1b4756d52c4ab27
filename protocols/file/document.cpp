#include "protocols/file/document.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <toml++/toml.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"

namespace palpate::protocols {
namespace {

Position position_of(const toml::source_region& source) {
    // The library says line 0 for what has no place of its own, such as the file as a whole.
    return {std::max<std::size_t>(source.begin.line, 1),
            std::max<std::size_t>(source.begin.column, 1)};
}

Value value_of(const toml::node& node);

Table table_of(const toml::table& from) {
    Table table;
    for (const auto& [key, node] : from) {
        table.push_back({std::string(key.str()), position_of(key.source()), value_of(node)});
    }
    // The library sorts by name.
    std::ranges::stable_sort(table, [](const Entry& a, const Entry& b) { return a.at < b.at; });
    return table;
}

Array array_of(const toml::array& from) {
    Array array;
    for (const toml::node& node : from) {
        array.push_back(value_of(node));
    }
    return array;
}

Value value_of(const toml::node& node) {
    Value value{.at = position_of(node.source()), .data = Moment{}};
    node.visit([&value](const auto& one) {
        if constexpr (toml::is_table<decltype(one)>) {
            value.data = table_of(one);
        } else if constexpr (toml::is_array<decltype(one)>) {
            value.data = array_of(one);
        } else if constexpr (requires { value.data = one.get(); }) {
            value.data = one.get();
        }
    });
    return value;
}

/// How deep a text goes, found without the library, whose trees are taken down level by level. As
/// far as the text is TOML this sees strings, keys and brackets as the library does, and the
/// library stops at the first place where it is not.
class DepthScan {
public:
    explicit DepthScan(std::string_view text) : text_(text) {}

    /// The first place that is too deep.
    std::optional<Position> too_deep() {
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '"' || c == '\'') {
                skip_string(c);
                continue;
            }
            if (c == '#') {
                at_ = std::min(text_.find('\n', at_), text_.size());
                continue;
            }
            if (take(c)) {
                return position();
            }
            ++at_;
        }
        return std::nullopt;
    }

private:
    /// @return whether that is one too many
    bool take(char c) {
        if (c == '\n' && open_.empty()) {
            begin_key();
        } else if (in_key_ && c == '.') {
            return ++parts_ > kMaxLevels;
        } else if (in_key_ && c == '=') {
            in_key_ = false;
        } else if (!in_key_ && (c == '[' || c == '{')) {
            open_.push_back(c);
            if (c == '{') {
                begin_key();
            }
            return open_.size() > kMaxLevels;
        } else if ((c == ']' || c == '}') && !open_.empty()) {
            open_.pop_back();
            in_key_ = false;
        } else if (c == ',' && !open_.empty() && open_.back() == '{') {
            begin_key();
        }
        return false;
    }

    void begin_key() {
        in_key_ = true;
        parts_ = 1;
    }

    /// A string of one line ends with the line, as an error or not; one of three quotes with three.
    void skip_string(char quote) {
        const std::string three(3, quote);
        const bool lines = text_.substr(at_, 3) == three;
        at_ += lines ? 3 : 1;
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '\n' && !lines) {
                return;
            }
            if (lines ? text_.substr(at_, 3) == three : c == quote) {
                at_ += lines ? 3 : 1;
                while (lines && at_ < text_.size() && text_[at_] == quote) {
                    ++at_;  // a quote or two before the last three belong to the string
                }
                return;
            }
            const bool escape =
                c == '\\' && quote == '"' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n';
            at_ += escape ? 2U : 1U;
        }
    }

    [[nodiscard]] Position position() const {
        const std::string_view before = text_.substr(0, at_);
        const auto lines = std::ranges::count(before, '\n');
        return {static_cast<std::size_t>(lines) + 1, at_ - before.rfind('\n')};
    }

    std::string_view text_;
    std::size_t at_ = 0;
    bool in_key_ = true;
    std::size_t parts_ = 1;
    std::string open_;  ///< brackets of arrays and inline tables
};

constexpr int kPatienceMs = 10'000;

/// The next bytes, appended to `text`. @return why there are none, empty at the end or after some
std::string read_more(int fd, std::string& text, bool& end) {
    pollfd one{.fd = fd, .events = POLLIN, .revents = 0};
    const int ready = poll(&one, 1, kPatienceMs);
    if (ready == 0) {
        return "nothing has come out of it for 10 s";
    }
    constexpr std::size_t kPiece = std::size_t{1} << 16U;
    const std::size_t before = text.size();
    text.resize(before + kPiece);
    const ssize_t got = ready < 0 ? -1 : ::read(fd, text.data() + before, kPiece);
    text.resize(before + (got > 0 ? static_cast<std::size_t>(got) : 0));
    end = got == 0;
    return got >= 0 || errno == EINTR || errno == EAGAIN ? ""
                                                         : std::generic_category().message(errno);
}

ProtocolError unreadable(const std::string& file, const std::string& why) {
    return ProtocolError(fmt::format("{}:1:1: cannot be read: {}; check the path", file, why));
}

}  // namespace

std::string_view kind_of(const Value& value) {
    constexpr std::array<std::string_view, 7> kKinds{
        "true or false", "an integer", "a number", "text", "a date or time", "an array", "a table"};
    return kKinds.at(value.data.index());
}

std::string shown(std::string_view text) {
    constexpr std::size_t kMax = 60;  // bytes; what follows says no more to the reader
    std::string out = "\"";
    for (const char c : text.substr(0, kMax)) {
        const bool plain = static_cast<unsigned char>(c) >= 0x20 && c != 0x7f;
        out += plain ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
    if (text.size() > kMax) {
        while (!out.empty() && (static_cast<unsigned char>(out.back()) & 0xC0U) == 0x80U) {
            out.pop_back();  // no half of a character
        }
        if (static_cast<unsigned char>(out.back()) >= 0xC0U) {
            out.pop_back();
        }
        out += "...";
    }
    return out + '"';
}

std::string shown(const Value& value) {
    return std::visit(
        [&value](const auto& data) {
            using Data = std::decay_t<decltype(data)>;
            if constexpr (std::is_same_v<Data, std::string>) {
                return shown(std::string_view(data));
            } else if constexpr (std::is_arithmetic_v<Data>) {
                return fmt::format("{}", data);
            } else if constexpr (std::is_same_v<Data, Array>) {
                return fmt::format("an array of {}", data.size());
            } else {
                return std::string(kind_of(value));
            }
        },
        value.data);
}

Table parse_document(std::string_view text, std::string_view file_name) {
    refuse_if<ProtocolError>(text.size() > kMaxDocument,
                             "{}:1:1: the text has {} bytes: give at most {}", file_name,
                             text.size(), kMaxDocument);
    if (const auto deep = DepthScan(text).too_deep()) {
        throw ProtocolError(fmt::format(
            "{}:{}:{}: more than {} levels in one another: no key of a file lies so deep, take the "
            "dots or brackets away",
            file_name, deep->line, deep->column, kMaxLevels));
    }
    try {
        return table_of(toml::parse(text, std::string_view{}));
    } catch (const toml::parse_error& error) {
        const Position at = position_of(error.source());
        std::string what(error.description());
        std::ranges::replace(what, '\n', ' ');
        throw ProtocolError(fmt::format("{}:{}:{}: not TOML: {}; see https://toml.io", file_name,
                                        at.line, at.column, what));
    }
}

TextPieces::TextPieces(const std::filesystem::path& file, std::size_t max)
    : file_(file.string()), max_(max) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) {
        throw unreadable(file_, "it is a folder");
    }
    text_ = Descriptor(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (text_.get() < 0) {
        throw unreadable(file_, std::generic_category().message(errno));
    }
}

bool TextPieces::next(std::string& text) {
    const std::size_t before = text.size();
    for (bool end = false; !end && text.size() == before;) {
        if (const std::string why = read_more(text_.get(), text, end); !why.empty()) {
            throw unreadable(file_, why);
        }
    }
    read_ += text.size() - before;
    if (read_ > max_) {
        throw unreadable(file_, fmt::format("it is longer than {} bytes", max_));
    }
    return text.size() > before;
}

std::string read_text(const std::filesystem::path& file, std::size_t max) {
    std::string text;
    TextPieces pieces(file, max);
    while (pieces.next(text)) {
    }
    return text;
}

std::string toml_version() {
    return fmt::format("{}.{}.{}", TOML_LIB_MAJOR, TOML_LIB_MINOR, TOML_LIB_PATCH);
}

}  // namespace palpate::protocols
