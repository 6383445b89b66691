#include <cstring>

#include "gl_support.h"

using namespace wavefog;
using namespace wavefog::test;

TEST_CASE("osmesa gives OpenGL 4.5 core without a display") {
    const auto context = create_context("osmesa");
    REQUIRE(context.has_value());
    CHECK((*context)->name() == "osmesa");
    CHECK((*context)->version().starts_with("4.5 (Core Profile)"));
    CHECK_FALSE((*context)->renderer().empty());
    GLint profile = 0;
    (*context)->gl().GetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    CHECK((profile & GL_CONTEXT_CORE_PROFILE_BIT) != 0);
}

TEST_CASE("two contexts live side by side") {
    auto first = create_context();
    auto second = create_context();
    REQUIRE(first.has_value());
    REQUIRE(second.has_value());
    REQUIRE((*first)->make_current().has_value());
    const Texture texture =
        make_texture_2d((*first)->gl(), GL_R8, 2, 2, GL_RED, GL_UNSIGNED_BYTE, nullptr);
    CHECK((*first)->gl().GetError() == GL_NO_ERROR);
    second->reset();
    CHECK((*first)->make_current().has_value());
}

TEST_CASE("egl works or says what is missing") {
    const auto context = create_context("egl");
    if (context) {
        CHECK((*context)->name() == "egl");
        CHECK((*context)->version().substr(0, 3) >= "4.5");
    } else {
        MESSAGE("no EGL driver here: " << context.error().message);
        CHECK(context.error().kind == ErrorKind::data);
        CHECK(context.error().message.starts_with("egl: "));
        CHECK(context.error().message.find("osmesa") != std::string::npos);
    }
}

TEST_CASE("an unknown context is a usage error that lists what there is") {
    const auto context = create_context("vulkan");
    REQUIRE_FALSE(context.has_value());
    CHECK(context.error().kind == ErrorKind::usage);
    CHECK(context.error().message == "context \"vulkan\" is unknown; choose osmesa or egl");
}

TEST_CASE("the loader names the function that a context lacks") {
    const auto gl = load_gl([](const char* name) -> void* {
        static int some_function = 0;
        return std::strcmp(name, "glClipControl") == 0 ? nullptr : &some_function;
    });
    REQUIRE_FALSE(gl.has_value());
    CHECK(gl.error().kind == ErrorKind::data);
    CHECK(gl.error().message.find("lacks glClipControl") != std::string::npos);

    const auto none = load_gl(nullptr);
    REQUIRE_FALSE(none.has_value());
    CHECK(none.error().kind == ErrorKind::usage);
}
