/**
 * @class vtkChiaroRepresentation
 * @brief image data in natural light
 *
 * The representation "Chiaro": as "Volume", drawn by vtkChiaroVolumeMapper. Over several processes each keeps ghost
 * cells, light is found together, in ProcessViewRequest, and the processes' pictures are composited by ParaView.
 */
#ifndef vtkChiaroRepresentation_h
#define vtkChiaroRepresentation_h

#include "vtkChiaroRepresentationModule.h"  // for export macro
#include "vtkImageVolumeRepresentation.h"

#include <memory>  // for std::unique_ptr

class VTKCHIAROREPRESENTATION_EXPORT vtkChiaroRepresentation : public vtkImageVolumeRepresentation {
public:
    static vtkChiaroRepresentation* New();
    vtkTypeMacro(vtkChiaroRepresentation, vtkImageVolumeRepresentation);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in, vtkInformation* out) override;

    ///@{
    /**
     * As vtkChiaroVolumeMapper::SetSetting.
     */
    void SetSetting(const char* name, const char* value);
    void SetSetting(const char* name, double value);
    void SetSetting(const char* name, int value);
    ///@}
    /**
     * A setting that is on or off.
     */
    void SetSwitch(const char* name, int on);

    ///@{
    /**
     * Of vtkVolumeMapper's blend modes: Volume's own choice, and one that stands in its place (0: none).
     */
    void SetBlendMode(int mode);
    void SetValueOfRays(int mode);
    ///@}
    /**
     * As vtkChiaroVolumeMapper::SetScene; over several processes drawn with exact compositing.
     */
    void SetScene(const char* file);

    /**
     * As vtkChiaroVolumeMapper::SetFrameFile.
     */
    void SetFrameFile(const char* file);

    ///@{
    /**
     * Layers of ghost cells that each of several processes asks for; 16 by default.
     */
    void SetGhostLevels(int levels);
    vtkGetMacro(GhostLevels, int);
    ///@}

    ///@{
    /**
     * Whether several processes' pictures are blended as floats, and no geometry but Chiaro's is in the view; off by
     * default: ParaView composites windows' pixels, of 8 bits.
     */
    vtkSetMacro(ExactCompositing, bool);
    vtkGetMacro(ExactCompositing, bool);
    ///@}

protected:
    vtkChiaroRepresentation();
    ~vtkChiaroRepresentation() override;

    bool AddToView(vtkView* view) override;
    bool RemoveFromView(vtkView* view) override;
    int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** in, vtkInformationVector* out) override;
    int RequestData(vtkInformation* request, vtkInformationVector** in, vtkInformationVector* out) override;

private:
    vtkChiaroRepresentation(const vtkChiaroRepresentation&) = delete;
    void operator=(const vtkChiaroRepresentation&) = delete;

    bool SetBlock();
    void FindLight(vtkInformation* in);
    void DrawTogether();
    void LeaveUnsmoothed();

    int GhostLevels = 16;
    bool ExactCompositing = false;
    int OwnBlendMode = 0, ValueOfRays = 0;
    int Own[6] = {0, -1, 0, -1, 0, -1};  // extent of what is no ghost
    bool HasLight = false;               // on all processes
    struct Shown;
    std::unique_ptr<Shown> Drawn;
};

#endif
