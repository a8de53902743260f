// The least that speaks server/PROTOCOL.md: shows the picture; drag turns it, the wheel zooms.
const canvas = document.querySelector('canvas'), status = document.querySelector('p');
const token = new URLSearchParams(location.search).get('token');
const view = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) => byte.toString(16).padStart(2, '0')).join('');
const socket = new WebSocket(`ws://${location.host}/socket?token=${token}&view=${view}`);
socket.binaryType = 'arraybuffer';
let scene = null, n = 0, shown = 0, still = 0;

function send(moving) {
    if (!scene) return;
    const size = [Math.round(canvas.clientWidth * devicePixelRatio), Math.round(canvas.clientHeight * devicePixelRatio)];
    socket.send(JSON.stringify({type: 'state', n: ++n, scene, canvas: size, moving}));
    clearTimeout(still);
    if (moving) still = setTimeout(() => send(false), 120);
}

async function show(buffer) {
    const length = new DataView(buffer).getUint32(4, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
    if (header.kind !== 'state' || header.n < shown) return;
    const picture = await createImageBitmap(new Blob([new Uint8Array(buffer, 8 + length)], {type: `image/${header.type}`}));
    if (header.n < shown) return;
    shown = header.n;
    [canvas.width, canvas.height] = header.canvas;
    canvas.getContext('2d').drawImage(picture, 0, 0, canvas.width, canvas.height);
    status.textContent = header.stage;
}

socket.onmessage = ({data}) => {
    if (data instanceof ArrayBuffer) return show(data);
    const message = JSON.parse(data);
    if (message.sentence) status.textContent = message.sentence;
    if (message.scene) scene = message.scene, send(false);
};
socket.onclose = () => { status.textContent = 'Connection lost'; };
canvas.onpointermove = (event) => {
    if (!event.buttons || !scene) return;
    scene.camera.azimuth_deg -= event.movementX / 3;
    scene.camera.elevation_deg = Math.max(-90, Math.min(90, scene.camera.elevation_deg + event.movementY / 3));
    send(true);
};
canvas.onwheel = (event) => {
    if (!scene) return;
    event.preventDefault();
    scene.camera.fit_scale *= Math.exp(event.deltaY / 1000);
    send(true);
};
addEventListener('resize', () => send(false));
