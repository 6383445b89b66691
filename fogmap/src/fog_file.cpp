#include "wavefog/fogmap/fog_file.h"

namespace wavefog {

Result<void> save_fog(const std::filesystem::path& file, const Fog&, const SaveOptions&) {
    return data_error(file.string() + ": fog files come with the next commit");
}
Result<Fog> load_fog(const std::filesystem::path& file) {
    return data_error(file.string() + ": fog files come with the next commit");
}
bool is_fog_file(const std::filesystem::path&) {
    return false;
}

}  // namespace wavefog
