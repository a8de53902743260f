#include "vtkChiaroRepresentation.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "blend.h"
#include "exchange.h"
#include "vtkAlgorithmOutput.h"
#include "vtkCellData.h"
#include "vtkChiaroVolumeMapper.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkOutlineSource.h"
#include "vtkPVLODVolume.h"
#include "vtkPVRenderView.h"
#include "vtkPointData.h"
#include "vtkProp3D.h"
#include "vtkPropCollection.h"
#include "vtkRenderer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"
#include "vtkWeakPointer.h"

vtkStandardNewMacro(vtkChiaroRepresentation);

namespace {

/// Cells that are no ghosts, as an extent of points; one that ends before it begins: there are none.
void find_own(vtkImageData& image, int own[6]) {
    image.GetExtent(own);
    const auto* ghosts =
        vtkUnsignedCharArray::SafeDownCast(image.GetCellData()->GetArray(vtkDataSetAttributes::GhostArrayName()));
    if (!ghosts) return;
    int cells[3], least[3] = {VTK_INT_MAX, VTK_INT_MAX, VTK_INT_MAX}, most[3] = {-1, -1, -1};
    for (int a = 0; a < 3; ++a) cells[a] = std::max(own[2 * a + 1] - own[2 * a], 1);
    vtkIdType cell = 0;
    for (int z = 0; z < cells[2]; ++z)
        for (int y = 0; y < cells[1]; ++y)
            for (int x = 0; x < cells[0]; ++x, ++cell) {
                if (ghosts->GetValue(cell) & vtkDataSetAttributes::DUPLICATECELL) continue;
                const int at[3] = {x, y, z};
                for (int a = 0; a < 3; ++a) least[a] = std::min(least[a], at[a]), most[a] = std::max(most[a], at[a]);
            }
    for (int a = 0; a < 3; ++a) {
        const int first = own[2 * a];
        own[2 * a] = most[a] < 0 ? first : first + least[a];
        own[2 * a + 1] = most[a] < 0 ? first - 1 : std::min(first + most[a] + 1, own[2 * a + 1]);
    }
}

/// Whether the renderer shows anything but Chiaro's volumes.
bool shows_others(vtkRenderer& renderer) {
    vtkCollectionSimpleIterator at;
    vtkPropCollection* props = renderer.GetViewProps();
    props->InitTraversal(at);
    while (vtkProp* prop = props->GetNextProp(at)) {
        if (!prop->GetVisibility() || !vtkProp3D::SafeDownCast(prop)) continue;
        auto* volume = vtkVolume::SafeDownCast(prop);
        if (volume && vtkChiaroVolumeMapper::SafeDownCast(volume->GetMapper())) continue;
        if (const double* bounds = prop->GetBounds(); bounds && vtkMath::AreBoundsInitialized(bounds)) return true;
    }
    return false;
}

/// What a process without data learns of the others' grid.
struct Grid {
    int is_known = 0, whole[6]{}, unused = 0;
    double origin[3]{}, spacing[3]{1, 1, 1}, direction[9]{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

}  // namespace

/// The renderer that draws it, and what is done beside that.
struct vtkChiaroRepresentation::Shown {
    vtkWeakPointer<vtkRenderer> renderer;
    std::vector<unsigned long> observers;
    std::unique_ptr<chiaro::from_paraview::FloatBlend> blend;  ///< none: there is one process
};

vtkChiaroRepresentation::vtkChiaroRepresentation() {
    this->VolumeMapper = vtkSmartPointer<vtkChiaroVolumeMapper>::New();
}
vtkChiaroRepresentation::~vtkChiaroRepresentation() = default;

void vtkChiaroRepresentation::SetSetting(const char* name, const char* value) {
    static_cast<vtkChiaroVolumeMapper&>(*this->VolumeMapper).SetSetting(name, value);
}
void vtkChiaroRepresentation::SetSetting(const char* name, double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    this->SetSetting(name, text);
}
void vtkChiaroRepresentation::SetSetting(const char* name, int value) {
    this->SetSetting(name, std::to_string(value).c_str());
}
void vtkChiaroRepresentation::SetSwitch(const char* name, int on) { this->SetSetting(name, on ? "true" : "false"); }

void vtkChiaroRepresentation::SetBlendMode(int mode) {
    this->OwnBlendMode = mode;
    this->Superclass::SetBlendMode(this->ValueOfRays ? this->ValueOfRays : mode);
}

void vtkChiaroRepresentation::SetValueOfRays(int mode) {
    this->ValueOfRays = mode;
    this->SetBlendMode(this->OwnBlendMode);
}

void vtkChiaroRepresentation::SetScene(const char* file) {
    static_cast<vtkChiaroVolumeMapper&>(*this->VolumeMapper).SetScene(file);
}

void vtkChiaroRepresentation::SetFrameFile(const char* file) {
    static_cast<vtkChiaroVolumeMapper&>(*this->VolumeMapper).SetFrameFile(file);
}

void vtkChiaroRepresentation::SetGhostLevels(int levels) {
    levels = std::clamp(levels, 0, 64);
    if (levels == this->GhostLevels) return;
    this->GhostLevels = levels;
    this->MarkModified();
}

int vtkChiaroRepresentation::RequestUpdateExtent(vtkInformation* request, vtkInformationVector** in,
                                                 vtkInformationVector* out) {
    const int done = this->Superclass::RequestUpdateExtent(request, in, out);
    if (chiaro::from_paraview::ranks() && in[0]->GetNumberOfInformationObjects() == 1)
        in[0]->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(),
                                            this->GhostLevels);
    return done;
}

// As the superclass, which crops ghosts away.
int vtkChiaroRepresentation::RequestData(vtkInformation* request, vtkInformationVector** in,
                                         vtkInformationVector* out) {
    vtkImageData* image = in[0]->GetNumberOfInformationObjects() == 1 ? vtkImageData::GetData(in[0], 0) : nullptr;
    if (!image || !image->HasAnyGhostCells()) {
        std::fill_n(this->Own, 6, -1);
        if (image) image->GetExtent(this->Own);
        return this->Superclass::RequestData(request, in, out);
    }
    find_own(*image, this->Own);
    vtkNew<vtkImageData> cache, own;
    cache->ShallowCopy(image);
    cache->GetPointData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
    cache->GetCellData()->RemoveArray(vtkDataSetAttributes::GhostArrayName());
    own->CopyStructure(image);
    own->SetExtent(this->Own);
    this->Actor->SetEnableLOD(0);
    this->VolumeMapper->SetInputData(cache);
    this->OutlineSource->SetBounds(own->GetBounds());
    this->OutlineSource->GetBounds(this->DataBounds);
    this->OutlineSource->Update();
    this->DataSize = cache->GetActualMemorySize();
    vtkStreamingDemandDrivenPipeline::GetWholeExtent(in[0]->GetInformationObject(0), this->WholeExtent);
    this->Cache = cache.GetPointer();
    return this->vtkVolumeRepresentation::RequestData(request, in, out);
}

int vtkChiaroRepresentation::ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in,
                                                vtkInformation* out) {
    if (!this->Superclass::ProcessViewRequest(request, in, out)) return 0;
    if (request == vtkPVView::REQUEST_UPDATE()) {
        // Blocks are parted where ghosts begin, and every process takes part in each frame.
        vtkPVRenderView::SetOrderedCompositingConfiguration(in, this, vtkPVRenderView::USE_BOUNDS_FOR_REDISTRIBUTION,
                                                            this->DataBounds);
        if (chiaro::from_paraview::ranks()) out->Set(vtkPVRenderView::RENDER_EMPTY_IMAGES(), 1);
    }
    if (request == vtkPVView::REQUEST_RENDER()) this->FindLight(in);
    return 1;
}

/// Tells the mapper which block of which whole this process has; collective. False: nobody has any.
bool vtkChiaroRepresentation::SetBlock() {
    auto& mapper = static_cast<vtkChiaroVolumeMapper&>(*this->VolumeMapper);
    const std::shared_ptr<chiaro::Exchange> ranks = chiaro::from_paraview::ranks();
    auto* image = vtkImageData::SafeDownCast(this->Cache);
    Grid grid;
    if (image && image->GetNumberOfPoints() > 0) {
        grid.is_known = 1;
        std::copy_n(this->WholeExtent, 6, grid.whole);
        image->GetOrigin(grid.origin), image->GetSpacing(grid.spacing);
        std::copy_n(image->GetDirectionMatrix()->GetData(), 9, grid.direction);
    }
    const bool has_any = grid.is_known;
    for (const auto& bytes : ranks->gather(std::as_bytes(std::span(&grid, 1)))) {
        Grid other;
        std::memcpy(&other, bytes.data(), sizeof other);
        if (!grid.is_known && other.is_known) grid = other;
    }
    if (!grid.is_known) return false;
    vtkNew<vtkImageData> whole;
    whole->SetExtent(grid.whole);
    whole->SetOrigin(grid.origin), whole->SetSpacing(grid.spacing);
    whole->SetDirectionMatrix(grid.direction);
    const bool at_cells = this->VolumeMapper->GetScalarMode() == VTK_SCALAR_MODE_USE_CELL_FIELD_DATA;
    int own[6]{};
    for (int a = 0; has_any && a < 3; ++a) {
        const int first = this->Own[2 * a], last = this->Own[2 * a + 1];
        own[2 * a] = first;
        own[2 * a + 1] = last < first ? first
                         : at_cells   ? std::max(last, first + 1)
                                      : last + (last == grid.whole[2 * a + 1] ? 1 : 0);
    }
    mapper.SetBlock(ranks, whole, own);
    return true;
}

void vtkChiaroRepresentation::FindLight(vtkInformation* in) {
    auto* view = vtkPVRenderView::SafeDownCast(in->Get(vtkPVView::VIEW()));
    if (!view || !chiaro::from_paraview::ranks()) return;
    this->HasLight = false;
    if (!this->SetBlock()) return;
    this->VolumeMapper->Update();
    this->HasLight =
        static_cast<vtkChiaroVolumeMapper&>(*this->VolumeMapper).FindLight(view->GetRenderer(), this->Actor);
}

// A renderer's start is where ParaView's own processes meet and take over the first one's camera: they come after that.
bool vtkChiaroRepresentation::AddToView(vtkView* view) {
    if (auto* render_view = vtkPVRenderView::SafeDownCast(view)) {
        this->Drawn = std::make_unique<Shown>();
        vtkRenderer* renderer = this->Drawn->renderer = render_view->GetRenderer();
        std::vector<unsigned long>& observers = this->Drawn->observers;
        observers.push_back(
            renderer->AddObserver(vtkCommand::StartEvent, this, &vtkChiaroRepresentation::LeaveUnsmoothed, 1.0f));
        if (chiaro::from_paraview::ranks()) {
            this->Drawn->blend = std::make_unique<chiaro::from_paraview::FloatBlend>();
            observers.push_back(
                renderer->AddObserver(vtkCommand::StartEvent, this, &vtkChiaroRepresentation::DrawTogether, -1.0f));
            observers.push_back(renderer->AddObserver(vtkCommand::EndEvent,
                                                      static_cast<vtkChiaroVolumeMapper*>(this->VolumeMapper.Get()),
                                                      &vtkChiaroVolumeMapper::EndDrawTogether));
        }
    }
    return this->Superclass::AddToView(view);
}

bool vtkChiaroRepresentation::RemoveFromView(vtkView* view) {
    if (this->Drawn && this->Drawn->renderer)
        for (const unsigned long observer : this->Drawn->observers) this->Drawn->renderer->RemoveObserver(observer);
    this->Drawn.reset();
    return this->Superclass::RemoveFromView(view);
}

/// What several processes or a server have drawn is smoothed as a whole, volumes too, where ParaView shows those of one
/// process as they are; and `UseFXAA` is on again in all views whenever one is opened. The view says it before each
/// render, and its processes' synchronizer asks after this.
void vtkChiaroRepresentation::LeaveUnsmoothed() {
    vtkRenderer& renderer = *this->Drawn->renderer;
    if (this->GetVisibility() && !shows_others(renderer)) renderer.SetUseFXAA(false);
}

/// Collective.
void vtkChiaroRepresentation::DrawTogether() {
    auto& mapper = static_cast<vtkChiaroVolumeMapper&>(*this->VolumeMapper);
    vtkRenderer* renderer = this->Drawn->renderer;
    if (!this->GetVisibility() || !this->HasLight || renderer->GetSelector()) return;
    const bool is_blended = mapper.GetBlendMode() == vtkVolumeMapper::COMPOSITE_BLEND;
    if (is_blended && !this->ExactCompositing) return mapper.DrawApart();
    if (!chiaro::from_paraview::ranks()->agree(!shows_others(*renderer))) {
        if (is_blended)
            vtkWarningMacro(<< "exact compositing: not beside other geometry; ParaView composites, in 8 bits");
        return mapper.DrawApart();
    }
    mapper.DrawTogether(renderer, this->Actor, std::ref(*this->Drawn->blend));
}

void vtkChiaroRepresentation::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "GhostLevels: " << this->GhostLevels << "\n";
    os << indent << "ExactCompositing: " << this->ExactCompositing << "\n";
}
