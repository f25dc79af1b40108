// The page of ivory export --to web: a scene in three.js, lit by its baked grid. What it shows stands in page.json.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { LightProbeGridWebGL } from 'three/addons/lighting/LightProbeGridWebGL.js';
import { addControls } from './controls.js';
import { addLamps, addSpheres } from './lamps.js';
import { makeProbeGrid } from './light.js';

const element = ( id ) => document.getElementById( id );

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
