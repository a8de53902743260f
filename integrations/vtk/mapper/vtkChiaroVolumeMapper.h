/**
 * @class   vtkChiaroVolumeMapper
 * @brief   Draws a volume in Chiaro's light.
 *
 * Used like any other volume mapper: `volume->SetMapper(mapper)`. Input is vtkImageData with scalars of one component
 * at points or cells (of cells the values stand at their centres). Colour and scalar opacity functions, unit distance,
 * shade and its coefficients come from vtkVolumeProperty, the camera from the renderer, and rays end at what opaque
 * geometry the depth buffer has. Blend modes: composite, maximum, minimum, average (the mean, shown by the transfer
 * functions), additive (extinction times colour added up) and isosurface. Cropping to one box, and clipping planes, six
 * in all.
 *
 * What it does not draw it names in one warning, and draws nothing: see docs/vtk.md. Colours are composited as they
 * are, as other mappers do, unless the setting "color" or the window's sRGB colour space says otherwise.
 *
 * Cost: of the first picture the whole way from voxels to light, later only what is to the right of a change: a camera
 * move is rays, an edit of a function starts at classification. Memory: 1.4 times the voxels, and light.
 */

#ifndef vtkChiaroVolumeMapper_h
#define vtkChiaroVolumeMapper_h

#include "vtkChiaroModule.h"  // for export macro
#include "vtkVolumeMapper.h"

#include <functional>  // for std::function
#include <memory>      // for std::unique_ptr
#include <string>      // for std::string
#include <vector>      // for std::vector

#ifndef __VTK_WRAP__
namespace chiaro {
class Exchange;
struct Frame;
struct Scene;
namespace from_vtk {
struct Subject;
}
}  // namespace chiaro
#endif
class vtkImageData;

class VTKCHIARO_EXPORT vtkChiaroVolumeMapper : public vtkVolumeMapper {
public:
    static vtkChiaroVolumeMapper* New();
    vtkTypeMacro(vtkChiaroVolumeMapper, vtkVolumeMapper);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /**
     * Any setting of Chiaro by the name of its flag, such as ("albedo-max", "0.95"); it wins over what the property
     * says. An empty value takes it back. Not those of the camera and of files. False, with an error that says what was
     * wrong, for names and values that are none. GetSetting: what was set, else an empty text.
     */
    bool SetSetting(const char* name, const char* value);
    const char* GetSetting(const char* name);
    ///@}

    ///@{
    /**
     * The usual ones: method of lighting (spao, the default, none, visibility, histogram, transport, reference),
     * environment map (sky, studio, windows, three-point, white, or a file), how much of the occlusion is shown (0 to
     * 1).
     */
    bool SetLighting(const char* method) { return this->SetSetting("lighting", method); }
    bool SetProbe(const char* probe) { return this->SetSetting("probe", probe); }
    bool SetStrength(double strength);
    ///@}

    /**
     * Draws as the scene of a file says (JSON, or a picture that carries one), camera, size of steps and background
     * included; only its volume is not read. Settings do not count beside it; an empty name takes it back. Over several
     * processes it must be drawn together (DrawTogether), and state the points of its transfer function. False, with an
     * error that says what was wrong, for a file that is no scene.
     */
    bool SetScene(const char* file);

    /**
     * A file (.exr) that each picture's light is written to, too, as floats: what `chiaro render -o FILE.exr` writes,
     * without VTK's other things. Over several processes by the first one, where they are drawn together. An empty name
     * ends it. False, with an error, for another kind of file.
     */
    bool SetFrameFile(const char* file);

    ///@{
    /**
     * Distance of the samples along a ray, in world units. 0, the default: half of the smallest spacing.
     */
    vtkSetClampMacro(SampleDistance, double, 0, VTK_DOUBLE_MAX);
    vtkGetMacro(SampleDistance, double);
    ///@}

    ///@{
    /**
     * Pixels between rays, 1 to 10; 1 by default. With AutoAdjustSampleDistances (on) as many more as keep the time
     * that the render window allots, which is while one moves the camera.
     */
    vtkSetClampMacro(ImageSampleDistance, double, 1, 10);
    vtkGetMacro(ImageSampleDistance, double);
    vtkSetMacro(AutoAdjustSampleDistances, bool);
    vtkGetMacro(AutoAdjustSampleDistances, bool);
    vtkBooleanMacro(AutoAdjustSampleDistances, bool);
    ///@}

    ///@{
    /**
     * Whether rays end at opaque geometry, by the depth buffer; on by default.
     */
    vtkSetMacro(IntermixIntersectingGeometry, bool);
    vtkGetMacro(IntermixIntersectingGeometry, bool);
    vtkBooleanMacro(IntermixIntersectingGeometry, bool);
    ///@}

    ///@{
    /**
     * Threads, 0: all that the process may use.
     */
    vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
    vtkGetMacro(NumberOfThreads, int);
    ///@}

#ifndef __VTK_WRAP__
    /**
     * For volumes that several processes hold a block of each: the processes; the grid of the whole, without values;
     * and which points (or cells, of values of cells) of it this process' input owns: first and end along each axis,
     * half-open. The input may hold others too, which light is found from. Null: the input is whole.
     */
    void SetBlock(std::shared_ptr<chiaro::Exchange> ranks, vtkImageData* whole, const int own[6]);
    /**
     * Collective: what Render needs of other processes, which it never asks. False where nothing can be drawn, on any
     * of them.
     */
    bool FindLight(vtkRenderer* renderer, vtkVolume* volume);
    /**
     * Blends the processes' frames, which are premultiplied, in the order of these numbers of processes from the front
     * to the back; the first process gets the picture. Collective.
     */
    using Blend = std::function<void(chiaro::Frame& frame, const std::vector<int>& order)>;
    /**
     * Collective, after FindLight and before each Render: makes one picture of all processes' rays, under the first
     * one's camera, which Render shows there, and on no other; opaque geometry does not end its rays. False: Render
     * shows each process' block, as it does after DrawApart(), which it is where there is no `blend`, but for blend
     * modes of one value a ray.
     */
    bool DrawTogether(vtkRenderer* renderer, vtkVolume* volume, const Blend& blend);
    void DrawApart();
    /**
     * After the Render that followed DrawTogether, on all processes.
     */
    void EndDrawTogether();
#endif

    /**
     * Of the input; of all processes' blocks where they are drawn together, and wider than the window from DrawTogether
     * to EndDrawTogether where that draws a scene of a file: compositors leave out what lies beside the bounds.
     */
    using vtkVolumeMapper::GetBounds;
    double* GetBounds() VTK_SIZEHINT(6) override;

    /**
     * WARNING: INTERNAL METHOD - NOT INTENDED FOR GENERAL USE
     */
    void Render(vtkRenderer* renderer, vtkVolume* volume) override;
    void ReleaseGraphicsResources(vtkWindow* window) override;

protected:
    vtkChiaroVolumeMapper();
    ~vtkChiaroVolumeMapper() override;

private:
    vtkChiaroVolumeMapper(const vtkChiaroVolumeMapper&) = delete;
    void operator=(const vtkChiaroVolumeMapper&) = delete;

#ifndef __VTK_WRAP__
    void Draw(vtkRenderer* renderer, vtkVolume* volume);
    std::string Find(chiaro::from_vtk::Subject& subject, vtkVolume* volume);
    std::string Prepare(chiaro::from_vtk::Subject& subject, chiaro::Scene& scene, vtkRenderer* renderer,
                        vtkVolume* volume);
    bool Show(const chiaro::from_vtk::Subject& subject);
    void DrawOfAll(const chiaro::Scene& scene, vtkRenderer* renderer);
    bool Look(chiaro::Scene& scene, const chiaro::from_vtk::Subject& subject, vtkRenderer* renderer, vtkVolume* volume);
#endif
    void WarnOnce(const std::string& what);

    double SampleDistance = 0;
    double ImageSampleDistance = 1;
    bool AutoAdjustSampleDistances = true;
    bool IntermixIntersectingGeometry = true;
    int NumberOfThreads = 0;

    struct Internals;
    std::unique_ptr<Internals> Self;
};

#endif
