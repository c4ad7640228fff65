// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"

#include <mimetic/shared/error.hpp>
#include <mimetic/shared/threads.hpp>

namespace mimetic::bindings {
void bind_shared(pybind11::module_& m);
void bind_shared_rows(pybind11::module_& m);
void bind_raster(pybind11::module_& m);
void bind_raster_portrait(pybind11::module_& m);
void bind_raster_texture(pybind11::module_& m);
void bind_surface(pybind11::module_& m);
void bind_surface_face_lines(pybind11::module_& m);
void bind_surface_painted(pybind11::module_& m);
void bind_flow(pybind11::module_& m);
void bind_locate_eigenspace(pybind11::module_& m);
void bind_locate(pybind11::module_& m);
void bind_locate_landmarks(pybind11::module_& m);
void bind_locate_networks(pybind11::module_& m);
void bind_locate_still_cover(pybind11::module_& m);
void bind_fit(pybind11::module_& m);
void bind_fit_face_shape(pybind11::module_& m);
void bind_skin(pybind11::module_& m);
void bind_muscles(pybind11::module_& m);
void bind_muscles_skin_mesh(pybind11::module_& m);
void bind_muscles_attach(pybind11::module_& m);
void bind_muscles_extras(pybind11::module_& m);
void bind_muscles_eyeballs(pybind11::module_& m);
void bind_contact(pybind11::module_& m);
void bind_register(pybind11::module_& m);
void bind_register_face_units(pybind11::module_& m);
void bind_register_landmarks(pybind11::module_& m);
void bind_retarget(pybind11::module_& m);
void bind_head(pybind11::module_& m);
void bind_head_rig_motion(pybind11::module_& m);
void bind_solve(pybind11::module_& m);
void bind_solve_sightings(pybind11::module_& m);
void bind_solve_gaze(pybind11::module_& m);
void bind_solve_corrections(pybind11::module_& m);
void bind_analyse(pybind11::module_& m);
void bind_analyse_phases(pybind11::module_& m);
void bind_analyse_comparison(pybind11::module_& m);
void bind_analyse_composition(pybind11::module_& m);
void bind_puppet(pybind11::module_& m);
void bind_puppet_interpolate(pybind11::module_& m);
void bind_puppet_live(pybind11::module_& m);

namespace {

void register_exceptions(pybind11::module_& m) {
    pybind11::register_exception<InvalidInput>(m, "InvalidInput", PyExc_ValueError);
    pybind11::register_exception<UnreadableMedia>(m, "UnreadableMedia", PyExc_OSError);
    pybind11::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            std::rethrow_exception(thrown);
        } catch (const std::exception& error) {
            if (!says_no_memory(error)) {
                throw;  // to the next translator
            }
            pybind11::set_error(PyExc_MemoryError, error.what());
        }
    });
}

}  // namespace
}  // namespace mimetic::bindings

PYBIND11_MODULE(_core, m) {
    using namespace mimetic;
    m.doc() = "Mimetic's core: units are SI, images are uint8, arrays are C order.";
    m.attr("__version__") = MIMETIC_VERSION;
    bindings::register_exceptions(m);
    follow_thread_limit();
    // In the order of the stages; within one, a class before the signatures that name it, which the stubs
    // repeat
    bindings::bind_shared(m);
    bindings::bind_shared_rows(m);
    bindings::bind_raster(m);
    bindings::bind_raster_portrait(m);
    bindings::bind_raster_texture(m);
    bindings::bind_surface(m);
    bindings::bind_surface_face_lines(m);
    bindings::bind_surface_painted(m);
    bindings::bind_flow(m);
    bindings::bind_locate_eigenspace(m);
    bindings::bind_locate(m);
    bindings::bind_locate_landmarks(m);
    bindings::bind_locate_networks(m);
    bindings::bind_locate_still_cover(m);
    bindings::bind_fit(m);
    bindings::bind_fit_face_shape(m);
    bindings::bind_skin(m);
    bindings::bind_muscles(m);
    bindings::bind_muscles_skin_mesh(m);
    bindings::bind_muscles_attach(m);
    bindings::bind_muscles_extras(m);
    bindings::bind_muscles_eyeballs(m);
    bindings::bind_contact(m);
    bindings::bind_register(m);
    bindings::bind_register_face_units(m);
    bindings::bind_register_landmarks(m);
    bindings::bind_retarget(m);
    bindings::bind_head(m);
    bindings::bind_head_rig_motion(m);
    bindings::bind_solve(m);
    bindings::bind_solve_sightings(m);
    bindings::bind_solve_gaze(m);
    bindings::bind_solve_corrections(m);
    bindings::bind_analyse(m);
    bindings::bind_analyse_phases(m);
    bindings::bind_analyse_comparison(m);
    bindings::bind_analyse_composition(m);
    bindings::bind_puppet(m);
    bindings::bind_puppet_interpolate(m);
    bindings::bind_puppet_live(m);
}
