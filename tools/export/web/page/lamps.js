// The scene's lights in three.js: as the glTF file has them, and its spheres.
import * as THREE from 'three';

// WebGL promises 16 textures to a shader; materials, the grid and shadow maps share them.
const MOST_SHADOWS = 6;

// The file's node that placed an object.
function nodeOf( object, associations ) {

	for ( let o = object; o; o = o.parent ) {

		const node = associations.get( o )?.nodes;
		if ( node !== undefined ) return node;

	}

	return - 1;

}

export function addLamps( scene, root, gltf, about ) {

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

export function addSpheres( scene, about ) {

	for ( const { center, radius, radiance } of about.spheres ) {

		const ball = new THREE.Mesh( new THREE.SphereGeometry( radius, 32, 16 ),
			new THREE.MeshBasicMaterial( { color: new THREE.Color( ...radiance ) } ) );
		ball.position.set( ...center );
		scene.add( ball );

	}

}
