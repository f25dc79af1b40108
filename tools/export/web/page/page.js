// The page of ivory export --to web: a scene in three.js, lit by its baked grid. What it shows stands in page.json.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { LightProbeGridWebGL } from 'three/addons/lighting/LightProbeGridWebGL.js';
import { makeProbeGrid } from './light.js';

const element = ( id ) => document.getElementById( id );
// WebGL promises 16 textures to a shader; materials, the grid and shadow maps share them.
const MOST_SHADOWS = 6;

async function load( renderer ) {

	const about = await ( await fetch( 'page.json' ) ).json();
	const loader = new GLTFLoader();
	if ( about.draco ) {

		const { DRACOLoader } = await import( 'three/addons/loaders/DRACOLoader.js' );
		loader.setDRACOLoader( new DRACOLoader().setDecoderPath( './three/examples/jsm/libs/draco/gltf/' ) );

	}

	const textures = new KTX2Loader().detectSupport( renderer );
	const [ gltf, atlas ] = await Promise.all( [ loader.loadAsync( 'scene.glb' ), textures.loadAsync( 'light.ktx2' ) ] );
	return { about, gltf, atlas, textures };

}

// The file's node that placed an object.
function nodeOf( object, associations ) {

	for ( let o = object; o; o = o.parent ) {

		const node = associations.get( o )?.nodes;
		if ( node !== undefined ) return node;

	}

	return - 1;

}

function addLamps( scene, root, gltf, about ) {

	const found = [];
	root.traverse( ( o ) => o.isLight && found.push( o ) );
	const box = new THREE.Box3().setFromObject( root );
	const sphere = box.getBoundingSphere( new THREE.Sphere() );
	const lamps = [];
	for ( const light of found ) {

		const node = nodeOf( light, gltf.parser.associations );
		let lamp = light;
		if ( light.isDirectionalLight ) {

			// Its shadow is drawn from where it stands: outside of all.
			const w = new THREE.Vector3( 0, 0, 1 ).transformDirection( light.matrixWorld );
			lamp = new THREE.DirectionalLight( light.color, light.intensity );
			lamp.position.copy( sphere.center ).addScaledVector( w, 2 * sphere.radius );
			lamp.target.position.copy( sphere.center );
			scene.add( lamp, lamp.target );
			light.visible = false;
			Object.assign( lamp.shadow.camera, { left: - sphere.radius, right: sphere.radius, top: sphere.radius,
				bottom: - sphere.radius, near: 0.5 * sphere.radius, far: 3.5 * sphere.radius } );
			lamp.shadow.bias = - 1e-3;

		} else {

			// Depths go with near / distance: this bias is a four-hundredth of the radius at that distance.
			const near = Math.min( 0.02 * sphere.radius, 0.1 );
			Object.assign( lamp.shadow.camera, { near, far: 2.5 * sphere.radius } );
			lamp.shadow.bias = - 2.5e-3 * near / sphere.radius;

		}

		// Lamps whose direct light the grid holds would count twice.
		lamp.visible = ! about.stored.punctual;
		if ( lamp.visible && lamps.length < MOST_SHADOWS ) {

			lamp.castShadow = true;
			lamp.shadow.mapSize.set( 1024, 1024 );
			lamp.shadow.normalBias = 2e-3 * sphere.radius;

		}

		lamps.push( { lamp, intensity: lamp.intensity, group: about.lamps.find( ( l ) => l.node === node )?.group ?? '' } );

	}

	root.traverse( ( o ) => {

		if ( ! o.isMesh ) return;
		o.castShadow = ! o.material.transparent;
		o.receiveShadow = true;

	} );
	return lamps;

}

function addSpheres( scene, about ) {

	for ( const { center, radius, radiance } of about.spheres ) {

		const ball = new THREE.Mesh( new THREE.SphereGeometry( radius, 32, 16 ),
			new THREE.MeshBasicMaterial( { color: new THREE.Color( ...radiance ) } ) );
		ball.position.set( ...center );
		scene.add( ball );

	}

}

// Discs on the surfaces, red where this page shows too much light and blue where too little.
async function makeErrorMap( errors ) {

	const data = new DataView( await ( await fetch( errors.file ) ).arrayBuffer() );
	const discs = new THREE.InstancedMesh( new THREE.CircleGeometry( errors.radius_m, 6 ),
		new THREE.MeshBasicMaterial( { toneMapped: false } ), errors.count );
	const white = new THREE.Color( '#f7f7f7' ), red = new THREE.Color( '#b2182b' ), blue = new THREE.Color( '#2166ac' );
	const z = new THREE.Vector3( 0, 0, 1 ), n = new THREE.Vector3(), p = new THREE.Vector3(), colour = new THREE.Color();
	const turn = new THREE.Quaternion(), one = new THREE.Vector3( 1, 1, 1 ), matrix = new THREE.Matrix4();
	for ( let i = 0; i < errors.count; i ++ ) {

		const at = 10 * i;
		for ( let axis = 0; axis < 3; axis ++ ) {

			p.setComponent( axis, errors.low[ axis ] + errors.extent[ axis ] * data.getUint16( at + 2 * axis, true ) / 65535 );
			n.setComponent( axis, data.getInt8( at + 6 + axis ) / 127 );

		}

		n.normalize();
		turn.setFromUnitVectors( z, n );
		discs.setMatrixAt( i, matrix.compose( p.addScaledVector( n, 0.1 * errors.radius_m ), turn, one ) );
		const off = data.getInt8( at + 9 ) / 127;
		discs.setColorAt( i, colour.lerpColors( white, off > 0 ? red : blue, Math.abs( off ) ) );

	}

	discs.frustumCulled = false;
	return discs;

}

// The sum of the groups' atlases, each by its strength.
class Groups {

	constructor( groups, total, textures ) {

		this.groups = groups.map( ( g ) => ( { ...g, factor: 1, data: null } ) );
		this.total = total;
		this.textures = textures;
		this.mixed = null;

	}

	async load() {

		await Promise.all( this.groups.map( async ( g ) => {

			const { image, type } = await this.textures.loadAsync( g.file );
			g.data = type === THREE.FloatType ? image.data : Float32Array.from( image.data, THREE.DataUtils.fromHalfFloat );

		} ) );

	}

	// As baked, the sum that the file holds.
	async atlas() {

		if ( this.groups.every( ( g ) => g.factor === 1 ) ) return this.total;
		if ( this.groups.some( ( g ) => g.data === null ) ) await this.load();
		const { width, height, depth } = this.total.image;
		const sum = new Float32Array( 4 * width * height * depth );
		for ( const { data, factor } of this.groups ) for ( let i = 0; i < sum.length; i ++ ) sum[ i ] += factor * data[ i ];
		const half = this.total.type === THREE.HalfFloatType;
		const values = half ? Uint16Array.from( sum, THREE.DataUtils.toHalfFloat ) : sum;
		if ( this.mixed === null ) {

			this.mixed = new THREE.Data3DTexture( values, width, height, depth );
			Object.assign( this.mixed, { format: THREE.RGBAFormat, type: this.total.type, minFilter: THREE.LinearFilter,
				magFilter: THREE.LinearFilter, unpackAlignment: 1 } );

		}

		this.mixed.image.data = values;
		this.mixed.needsUpdate = true;
		return this.mixed;

	}

}

class Page {

	constructor( renderer, { about, gltf, atlas, textures } ) {

		this.renderer = renderer;
		this.about = about;
		this.mode = 'on';
		this.split = 0.5;
		this.stops = 0;
		this.scene = new THREE.Scene();
		this.scene.background = new THREE.Color( 0x060606 );
		const root = gltf.scene;
		root.scale.multiplyScalar( about.scale );
		this.scene.add( root );
		root.updateMatrixWorld( true );
		this.lamps = addLamps( this.scene, root, gltf, about );
		addSpheres( this.scene, about );

		this.grid = makeProbeGrid( atlas, LightProbeGridWebGL );
		this.scene.add( this.grid );
		this.groups = new Groups( about.groups, atlas, textures );
		this.atlas = atlas;
		// In place of the atlas where the grid is off: shaders stay as they are.
		this.dark = new THREE.Data3DTexture( new Uint16Array( 4 ), 1, 1, 1 );
		Object.assign( this.dark, { format: THREE.RGBAFormat, type: THREE.HalfFloatType, minFilter: THREE.LinearFilter,
			magFilter: THREE.LinearFilter, needsUpdate: true } );
		if ( about.sky ) {

			this.sky = new THREE.LightProbe();
			this.sky.sh.fromArray( about.sky );
			this.scene.add( this.sky );

		}

		this.camera = new THREE.PerspectiveCamera();
		this.controls = new OrbitControls( this.camera, renderer.domElement );
		this.look( 0 );
		this.controls.addEventListener( 'change', () => this.draw() );
		renderer.toneMapping = THREE.NeutralToneMapping;
		renderer.shadowMap.enabled = true;
		renderer.shadowMap.autoUpdate = false;
		renderer.shadowMap.needsUpdate = true;

	}

	look( index ) {

		const view = this.about.views[ index ];
		this.camera.position.set( ...view.position );
		this.camera.up.set( ...view.up );
		this.camera.fov = view.yfov_deg;
		this.camera.near = this.about.near_m;
		this.camera.far = this.about.far_m;
		this.controls.target.set( ...view.target );
		this.controls.update();
		this.resize();

	}

	resize() {

		const { innerWidth: width, innerHeight: height } = window;
		this.renderer.setPixelRatio( Math.min( window.devicePixelRatio, 2 ) );
		this.renderer.setSize( width, height, false );
		this.camera.aspect = width / height;
		this.camera.updateProjectionMatrix();

	}

	// Before: the lamps, and the sky where it is given, which nothing shadows. After: the lamps and the grid.
	light( on ) {

		this.grid.texture = on ? this.atlas : this.dark;
		if ( this.sky ) this.sky.intensity = on ? 0 : 1;

	}

	draw() {

		if ( this.waiting ) return;
		this.waiting = true;
		requestAnimationFrame( () => {

			this.waiting = false;
			this.drawNow();

		} );

	}

	drawNow() {

		const { renderer, scene, camera } = this;
		renderer.toneMappingExposure = this.about.exposure * 2 ** this.stops;
		const { innerWidth: width, innerHeight: height } = window;
		const edge = Math.round( this.split * width );
		const parts = this.mode === 'split' ? [ [ 0, edge, false ], [ edge, width - edge, true ] ]
			: [ [ 0, width, this.mode === 'on' ] ];
		renderer.setScissorTest( this.mode === 'split' );
		for ( const [ x, w, on ] of parts ) {

			renderer.setScissor( x, 0, w, height );
			this.light( on );
			renderer.render( scene, camera );

		}

	}

	async setLights( name, factor ) {

		for ( const group of this.groups.groups ) if ( group.name === name ) group.factor = factor;
		for ( const l of this.lamps ) if ( l.group === name ) l.lamp.intensity = l.intensity * factor;
		this.atlas = await this.groups.atlas();
		this.draw();

	}

	// Radiance in nits of a view of the scene, rows from the bottom: for tests.
	radiance( index, width, height, { on = true, lamps = true } = {} ) {

		const { renderer } = this;
		const target = new THREE.WebGLRenderTarget( width, height, { type: THREE.FloatType } );
		const view = this.about.views[ index ];
		const camera = new THREE.PerspectiveCamera( view.yfov_deg, width / height, this.about.near_m, this.about.far_m );
		camera.position.set( ...view.position );
		camera.up.set( ...view.up );
		camera.lookAt( ...view.target );
		for ( const l of this.lamps ) if ( ! lamps ) l.lamp.intensity = 0;
		this.light( on );
		renderer.setScissorTest( false );
		renderer.setRenderTarget( target );
		renderer.render( this.scene, camera );
		const values = new Float32Array( 4 * width * height );
		renderer.readRenderTargetPixels( target, 0, 0, width, height, values );
		renderer.setRenderTarget( null );
		target.dispose();
		const strength = ( group ) => this.groups.groups.find( ( g ) => g.name === group )?.factor ?? 1;
		for ( const l of this.lamps ) l.lamp.intensity = l.intensity * strength( l.group );
		this.drawNow();
		return Array.from( values );

	}

}

function addControls( page ) {

	const { about } = page;
	document.title = about.title;
	element( 'title' ).textContent = about.title;
	about.views.forEach( ( view, i ) => element( 'view' ).add( new Option( view.name, i ) ) );
	element( 'view' ).onchange = ( e ) => {

		page.look( Number( e.target.value ) );
		page.draw();

	};
	element( 'exposure' ).oninput = ( e ) => {

		page.stops = Number( e.target.value );
		element( 'exposure-text' ).textContent = `${ page.stops > 0 ? '+' : '' }${ page.stops } stops`;
		page.draw();

	};

	const divider = element( 'divider' );
	const setMode = ( mode ) => {

		page.mode = mode;
		divider.hidden = mode !== 'split';
		divider.style.left = `${ 100 * page.split }%`;
		for ( const input of document.getElementsByName( 'grid' ) ) input.checked = input.value === mode;
		page.draw();

	};
	for ( const input of document.getElementsByName( 'grid' ) ) input.onchange = () => setMode( input.value );
	divider.onpointerdown = ( e ) => divider.setPointerCapture( e.pointerId );
	divider.onpointermove = ( e ) => {

		if ( ! divider.hasPointerCapture( e.pointerId ) ) return;
		page.split = Math.min( Math.max( e.clientX / window.innerWidth, 0 ), 1 );
		setMode( 'split' );

	};
	window.addEventListener( 'keydown', ( e ) => {

		if ( e.key === 'g' && ! e.ctrlKey ) setMode( page.mode === 'on' ? 'off' : 'on' );

	} );
	window.addEventListener( 'resize', () => {

		page.resize();
		page.draw();

	} );

	const names = new Set( [ ...about.groups.map( ( g ) => g.name ) ] );
	// Without groups the grid keeps the light of all lamps as it was baked: there is nothing to dim.
	element( 'lights' ).hidden = names.size === 0;
	for ( const name of names ) {

		const label = document.createElement( 'label' );
		const input = Object.assign( document.createElement( 'input' ), { type: 'range', min: 0, max: 2, step: 0.05, value: 1 } );
		input.dataset.group = name;
		input.oninput = () => page.setLights( name, Number( input.value ) );
		label.append( name, input );
		element( 'lights' ).append( label );

	}

	const percent = `${ ( 100 * about.errors.full ).toFixed( 0 ) } %`;
	element( 'scale-text' ).textContent = `${ percent } of mean E too dark … ${ percent } too bright`;
	let discs = null;
	element( 'errors' ).onchange = async ( e ) => {

		if ( discs === null ) page.scene.add( discs = await makeErrorMap( about.errors ) );
		discs.visible = e.target.checked;
		element( 'legend' ).hidden = ! e.target.checked;
		page.draw();

	};

	for ( const [ name, value ] of about.numbers ) {

		const row = element( 'numbers' ).insertRow();
		row.insertCell().textContent = name;
		row.insertCell().textContent = value;

	}

	for ( const note of about.notes ) element( 'notes' ).append( Object.assign( document.createElement( 'li' ), { textContent: note } ) );

}

async function start() {

	const renderer = new THREE.WebGLRenderer( { canvas: element( 'canvas' ), antialias: true } );
	const page = new Page( renderer, await load( renderer ) );
	addControls( page );
	page.drawNow();
	// Until its pixels are there, a frame is only asked for.
	renderer.getContext().readPixels( 0, 0, 1, 1, renderer.getContext().RGBA, renderer.getContext().UNSIGNED_BYTE, new Uint8Array( 4 ) );
	page.firstFrameMs = performance.now();
	element( 'message' ).hidden = true;
	return page;

}

window.ivory = start();
window.ivory.catch( ( error ) => {

	element( 'message' ).hidden = false;
	element( 'message' ).textContent = `This page cannot be shown: ${ error.message }`;
	throw error;

} );
