// SPDX-License-Identifier: Apache-2.0
// understudy._native, the implementation behind understudy/__init__.py. It takes plain values; the interface
// that users see, with its defaults and documentation, is in __init__.py.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "apps/python/array_volume.h"
#include "volume/transfer_control_points.h"

namespace py = pybind11;

namespace understudy::python {

namespace {

/// Holds a reference to the array while its data are in use.
class Volume {
 public:
  Volume(py::array array, const std::array<double, 3>& spacing, const std::string& nodes)
      : array_(std::move(array)) {
    volume::FileDescription description;
    for (int axis = 0; axis < 3; ++axis) description.size[std::size_t(axis)] = int(array_.shape(2 - axis));
    description.spacing = spacing;
    description.type = volume::scalar_type_named(type_of(array_)).value();
    const std::span<const std::byte> bytes(static_cast<const std::byte*>(array_.data()),
                                           std::size_t(array_.nbytes()));
    const py::gil_scoped_release released;
    volume_.emplace(Scalars{bytes, description}, nodes);
  }

  py::array_t<float> render(const launcher::SceneArguments& arguments, const std::string& control_points) {
    launcher::RgbaImage image;
    {
      const py::gil_scoped_release released;
      const std::scoped_lock lock(mutex_);
      image = volume_->render(arguments, control_points);
    }
    // The array takes ownership of the pixels.
    auto kept = std::make_unique<std::vector<float>>(std::move(image.rgba));
    const float* const pixels = kept->data();
    const py::capsule owner(kept.release(),
                            [](void* vector) { delete static_cast<std::vector<float>*>(vector); });
    return py::array_t<float>({image.height, image.width, 4}, pixels, owner);
  }

 private:
  static std::string type_of(const py::array& array) {
    const char kind = array.dtype().kind();
    return (kind == 'u' ? "u" : kind == 'i' ? "i" : "f") + std::to_string(array.itemsize() * 8);
  }

  py::array array_;
  std::mutex mutex_;  // serializes rendering by Python threads
  std::optional<ArrayVolume> volume_;
};

launcher::SceneArguments arguments_of(const py::dict& words) {
  launcher::SceneArguments arguments;
  const auto take = [&](const char* name, auto& value) {
    if (words.contains(name)) value = words[name].cast<std::decay_t<decltype(value)>>();
  };
  take("transfer_function", arguments.transfer_function);
  take("camera", arguments.camera);
  take("size", arguments.size);
  take("step", arguments.step);
  take("termination", arguments.termination);
  take("range", arguments.range);
  take("texels", arguments.texels);
  take("method", arguments.shading.method);
  take("tolerance", arguments.shading.tolerance);
  take("operator", arguments.shading.op);
  take("surfaces", arguments.shading.surfaces);
  take("no_volume", arguments.shading.no_volume);
  take("light", arguments.shading.light);
  take("light_from", arguments.shading.light_from);
  take("material", arguments.shading.material);
  return arguments;
}

}  // namespace

}  // namespace understudy::python

PYBIND11_MODULE(_native, module) {
  using understudy::python::Volume;
  module.attr("__version__") = UNDERSTUDY_VERSION;
  module.def("transfer_functions", understudy::volume::built_in_control_points_names);
  py::register_exception<understudy::python::NodesLost>(module, "NodesLost", PyExc_RuntimeError);
  py::class_<Volume>(module, "Volume")
      .def(py::init<py::array, const std::array<double, 3>&, const std::string&>())
      .def("render", [](Volume& volume, const py::dict& words, const std::string& control_points) {
        return volume.render(understudy::python::arguments_of(words), control_points);
      });
}
