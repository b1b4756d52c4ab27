# Writes OUTPUT, a C++ file that holds the protocol files FILES (separated by |) as texts, so that the
# program finds the protocols that ship with it wherever it is started; and PANTOGRAPHS, the calibrations
# that ship.
string(REPLACE "|" ";" files "${FILES}")
set(entries "")
foreach(file IN LISTS files)
    get_filename_component(name "${file}" NAME_WE)
    file(READ "${file}" text)
    string(APPEND entries "    {\"${name}\", R\"palpate_toml(${text})palpate_toml\"},\n")
endforeach()
file(READ "${PANTOGRAPHS}" pantographs)
file(WRITE "${OUTPUT}" "#include \"protocols/library/shipped.hpp\"

namespace palpate::protocols {
namespace {

constexpr ShippedProtocol kShipped[] = {
${entries}};

constexpr std::string_view kPantographs = R\"palpate_toml(${pantographs})palpate_toml\";

}  // namespace

std::span<const ShippedProtocol> shipped_protocols() noexcept { return kShipped; }

std::string_view shipped_pantographs() noexcept { return kPantographs; }

}  // namespace palpate::protocols
")
