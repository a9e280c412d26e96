#include <fmt/format.h>

#include <iterator>

#include "datasets/formats.h"

namespace touchstone {

// VTK XML, ascii. ParaView shows points only where Verts name them, and their radii as glyphs scaled by "radius".
std::string to_vtp(std::span<const Ball> balls) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n"
      "<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n"
      "<PointData Scalars=\"radius\">\n<DataArray type=\"Float32\" Name=\"radius\" format=\"ascii\">\n",
      balls.size());
  const auto out = std::back_inserter(text);
  for (const Ball& b : balls) fmt::format_to(out, "{}\n", b.r);
  text += "</DataArray>\n</PointData>\n<Points>\n<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (const Ball& b : balls) fmt::format_to(out, "{} {} {}\n", b.x, b.y, b.z);
  text += "</DataArray>\n</Points>\n<Verts>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n";
  for (std::size_t i = 0; i < balls.size(); ++i) fmt::format_to(out, "{}\n", i);
  text += "</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n";
  for (std::size_t i = 0; i < balls.size(); ++i) fmt::format_to(out, "{}\n", i + 1);
  text += "</DataArray>\n</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n";
  return text;
}

}  // namespace touchstone
