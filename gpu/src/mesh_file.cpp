#include "mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <fstream>

namespace wavefog {

namespace {

aiColor4D base_colour(const aiMaterial& material) {
    aiColor4D colour(0.6f, 0.6f, 0.6f, 1);
    if (material.Get(AI_MATKEY_BASE_COLOR, colour) != AI_SUCCESS)
        material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
    return colour;
}

aiColor3D emission(const aiMaterial& material) {
    aiColor3D colour(0, 0, 0);
    material.Get(AI_MATKEY_COLOR_EMISSIVE, colour);
    return colour;
}

bool finite(const aiVector3D& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

Result<MeshData> load_mesh(const std::filesystem::path& file) {
    const std::string name = file.string();
    // Assimp's own words for this ("Unable to open file") come without a reason.
    if (!std::ifstream(file))
        return data_error(name + ": cannot open the mesh; check the path and the permissions");

    Assimp::Importer importer;
    importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 60);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene = importer.ReadFile(
        name, aiProcess_Triangulate | aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices |
                  aiProcess_PreTransformVertices | aiProcess_SortByPType);
    if (!scene)
        return data_error(name + ": not a readable glTF or OBJ mesh (" + importer.GetErrorString() +
                          "); export it again as .glb or .obj");

    MeshData data;
    for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
        const aiMesh& mesh = *scene->mMeshes[m];
        if (!mesh.HasPositions() || !mesh.HasNormals()) continue;
        const aiColor4D base = base_colour(*scene->mMaterials[mesh.mMaterialIndex]);
        const aiColor3D glow = emission(*scene->mMaterials[mesh.mMaterialIndex]);
        const auto first = std::uint32_t(data.vertices.size());
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D& p = mesh.mVertices[v];
            if (!finite(p)) return data_error(name + ": a vertex is not finite; repair the mesh");
            const aiVector3D n = finite(mesh.mNormals[v]) ? mesh.mNormals[v] : aiVector3D(0, 1, 0);
            const aiColor4D tint =
                mesh.HasVertexColors(0) ? mesh.mColors[0][v] : aiColor4D(1, 1, 1, 1);
            data.vertices.push_back({{p.x, p.y, p.z},
                                     {n.x, n.y, n.z},
                                     {base.r * tint.r, base.g * tint.g, base.b * tint.b},
                                     {glow.r, glow.g, glow.b}});
        }
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices != 3) continue;
            for (unsigned k = 0; k < 3; ++k) data.indices.push_back(first + face.mIndices[k]);
        }
    }
    if (data.indices.empty())
        return data_error(name + ": holds no triangles; export a mesh with faces");
    return data;
}

}  // namespace wavefog
