#pragma once

#include "tests/support/std.hpp"

namespace palpate::tests {

/// One start tag of an SVG text.
struct SvgElement {
    std::string name;
    std::map<std::string, std::string> attributes;
    std::string text;  ///< characters directly after the tag

    [[nodiscard]] double number(const std::string& key) const {
        return std::strtod(attributes.at(key).c_str(), nullptr);
    }
    [[nodiscard]] bool is(std::string_view kind, std::string_view klass = {}) const {
        const auto found = attributes.find("class");
        return name == kind &&
               (klass.empty() || (found != attributes.end() && found->second == klass));
    }
};

/// A strict reader of the little XML that a chart needs: throws std::runtime_error at anything that
/// is not well-formed (tags that cross, attributes without quotes or twice, bare & or <, control
/// characters).
class SvgReader {
public:
    explicit SvgReader(std::string_view text) : text_(text) {
        while (at_ < text_.size()) {
            text_[at_] == '<' ? tag() : letters();
        }
        need(open_.empty() && roots_ == 1, "one element closed at the end");
    }
    [[nodiscard]] const std::vector<SvgElement>& elements() const { return elements_; }
    [[nodiscard]] std::vector<SvgElement> all(std::string_view kind,
                                              std::string_view klass = {}) const {
        std::vector<SvgElement> found;
        for (const SvgElement& e : elements_) {
            if (e.is(kind, klass)) {
                found.push_back(e);
            }
        }
        return found;
    }

private:
    void need(bool ok, const std::string& what) const {
        if (!ok) {
            throw std::runtime_error("not well-formed at byte " + std::to_string(at_) + ": " +
                                     what);
        }
    }
    static bool name_letter(char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == ':';
    }
    std::string word() {
        const std::size_t from = at_;
        while (at_ < text_.size() && name_letter(text_[at_])) {
            ++at_;
        }
        need(at_ > from, "a name");
        return std::string(text_.substr(from, at_ - from));
    }
    void space() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) {
            ++at_;
        }
    }
    void expect(char c) {
        need(at_ < text_.size() && text_[at_] == c, std::string("'") + c + "'");
        ++at_;
    }
    /// One character of text or of a value, entities resolved.
    std::string character() {
        if (text_[at_] != '&') {
            const auto c = static_cast<unsigned char>(text_[at_]);
            need(c >= 0x20 || c == '\n' || c == '\t', "no control character");
            return std::string(1, text_[at_++]);
        }
        static const std::map<std::string_view, std::string> kEntities{
            {"&amp;", "&"}, {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}};
        for (const auto& [entity, meaning] : kEntities) {
            if (text_.substr(at_, entity.size()) == entity) {
                at_ += entity.size();
                return meaning;
            }
        }
        need(false, "an entity");
        return {};
    }
    void letters() {
        std::string read;
        while (at_ < text_.size() && text_[at_] != '<') {
            read += character();
        }
        need(!open_.empty() || read.find_first_not_of(" \n") == std::string::npos,
             "text inside the root");
        if (!elements_.empty() && fresh_) {
            elements_.back().text += read;
        }
    }
    void tag() {
        expect('<');
        if (text_[at_] == '/') {
            ++at_;
            const std::string name = word();
            need(!open_.empty() && open_.back() == name, "</" + name + "> closes the last tag");
            open_.pop_back();
            expect('>');
            fresh_ = false;
            return;
        }
        SvgElement element{.name = word(), .attributes = {}, .text = {}};
        roots_ += open_.empty() ? 1 : 0;
        for (space(); at_ < text_.size() && name_letter(text_[at_]); space()) {
            const std::string key = word();
            expect('=');
            expect('"');
            std::string value;
            while (at_ < text_.size() && text_[at_] != '"') {
                need(text_[at_] != '<', "no < in a value");
                value += character();
            }
            expect('"');
            need(element.attributes.emplace(key, value).second, key + " only once");
        }
        if (at_ < text_.size() && text_[at_] == '/') {
            ++at_;
        } else {
            open_.push_back(element.name);
        }
        expect('>');
        elements_.push_back(std::move(element));
        fresh_ = true;
    }

    std::string_view text_;
    std::size_t at_ = 0;
    int roots_ = 0;
    bool fresh_ = false;  ///< a tag was opened just now: text is its own
    std::vector<std::string> open_;
    std::vector<SvgElement> elements_;
};

}  // namespace palpate::tests
